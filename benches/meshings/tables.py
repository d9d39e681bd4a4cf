"""Numbers as the page has them."""


def figure(value):
    """Two decimals, three below 0.1; – where there is none."""
    if value is None:
        return "–"
    return f"{value:.2f}" if value >= 0.0995 else f"{value:.3f}"


def seconds(t):
    return f"{t:.3g} s" if t >= 0.9995 else f"{t * 1e3:.3g} ms"
