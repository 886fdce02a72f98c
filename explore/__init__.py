"""The search: families of symmetric periodic orbits, their bifurcations, boxes for the verifier. Not rigorous."""

import os

# XLA reports on standard error that it takes some processors' tuning preferences for missing instructions
# (the code is then compiled again). It reads this once, when JAX is imported.
os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")
