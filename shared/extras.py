"""Packages that are not needed for everything, and the extra of orbitproof that installs each."""

from __future__ import annotations

_EXTRAS = {
    **dict.fromkeys(("jax", "jaxlib", "diffrax", "equinox", "optimistix", "mpmath", "scipy"), "explore"),
    **dict.fromkeys(("matplotlib", "jinja2", "latex2mathml"), "figures"),
    **dict.fromkeys(("ccsds_ndm", "xsdata", "lxml"), "oem"),
    "spiceypy": "spk",
    "pyarrow": "parquet",
    "plotly": "interactive",
    **dict.fromkeys(("distributed", "dask"), "cluster"),
}


def missing_extra(error: ModuleNotFoundError) -> str | None:
    """What to install if a package of an extra is what could not be imported, in one line; else `None`.

    >>> missing_extra(ModuleNotFoundError("No module named 'jax'", name="jax"))
    "jax is not installed: pip install 'orbitproof[explore]'"
    """
    package = (error.name or "").partition(".")[0]
    extra = _EXTRAS.get(package)
    return None if extra is None else f"{package} is not installed: pip install 'orbitproof[{extra}]'"
