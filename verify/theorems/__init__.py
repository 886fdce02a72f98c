"""One module for each kind of theorem about a box: `KIND` says all that differs between kinds (section 10.3)."""
