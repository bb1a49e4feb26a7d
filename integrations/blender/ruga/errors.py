"""The error that is shown to the artist."""


class RugaError(Exception):
    """What went wrong, where, and what to do about it: one message, shown as it is."""
