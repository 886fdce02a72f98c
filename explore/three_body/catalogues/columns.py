"""Names of the columns that follow the nine of a catalogue."""

LEAST, GREATEST, LEAST_FROM_LARGER = "least_distance", "greatest_distance", "least_from_larger"
"""Distances from the smaller primary, and from the larger one, over the whole orbit."""

ALTITUDE, HITS, PROVED = "altitude_km", "hits", "proved"
"""The least height above the smaller primary, whether the orbit meets that body, and what is proved."""

CLOSING = "closing_error"
"""How far the state after a period is from the first one."""

NUMERICAL = "no: double precision"
"""What is proved of a row that was only computed."""
