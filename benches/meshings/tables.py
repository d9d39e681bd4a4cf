"""Numbers in the form of the page."""


def figure(value):
    """A share with two decimals, three below 0.1; a dash for None."""
    if value is None:
        return "–"
    return f"{value:.2f}" if value >= 0.0995 else f"{value:.3f}"


def seconds(t):
    """A time with three significant digits, in s or ms."""
    return f"{t:.3g} s" if t >= 0.9995 else f"{t * 1e3:.3g} ms"
