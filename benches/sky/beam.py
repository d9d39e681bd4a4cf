"""Beams on maps of the sky: adwave's heat and healpy's harmonic `smoothing`, both against the exact harmonic answer.

A map is a sum of spherical harmonics with random coefficients around a mean of 1, so that its values after a Gaussian
beam are known at the centers of all pixels. Part of it is masked. Printed are root mean square errors relative to the
fluctuations of the true smoothed map, over the pixels farther from the mask than the beam is wide ("inside"), and over
the others ("at the mask"), where hidden pixels are unknown to every program.

    pip install -r benches/sky/requirements.txt
    python benches/sky/beam.py --command target/release/adwave
"""

import argparse
import subprocess
import tempfile
from pathlib import Path

import healpy
import numpy as np

# Slopes of the spectra l^slope: white noise, and ever smoother maps.
SLOPES = (0, -1, -2, -3)
MEAN = 1.0


def random_map(nside, slope, seed, fwhm):
    """A map of random harmonics of unit deviation around MEAN, and the same map after a beam."""
    rng = np.random.default_rng(seed)
    lmax = 2 * nside
    spectrum = np.arange(lmax + 1, dtype=float)
    spectrum[1:] **= slope
    n = healpy.Alm.getsize(lmax)
    alm = (rng.standard_normal(n) + 1j * rng.standard_normal(n)) / np.sqrt(2)
    alm[: lmax + 1] = rng.standard_normal(lmax + 1)
    alm = healpy.almxfl(alm, np.sqrt(spectrum))
    values = healpy.alm2map(alm, nside, lmax=lmax)
    deviation = values.std()
    smooth = healpy.alm2map(healpy.almxfl(alm, healpy.gauss_beam(np.radians(fwhm), lmax)), nside, lmax=lmax)
    return MEAN + values / deviation, MEAN + smooth / deviation


def random_mask(nside, seed):
    """True for the pixels that are known: outside a band around the equator and twelve discs."""
    rng = np.random.default_rng(1000 + seed)
    _, latitude = healpy.pix2ang(nside, np.arange(healpy.nside2npix(nside)), lonlat=True)
    known = np.abs(latitude) > rng.uniform(5, 20)
    for center in rng.standard_normal((12, 3)):
        known[healpy.query_disc(nside, center, np.radians(rng.uniform(2, 8)))] = False
    return known


def distance_to_mask(nside, known):
    """Degrees from each pixel to the nearest pixel that is not known."""
    from scipy.spatial import cKDTree

    centers = np.stack(healpy.pix2vec(nside, np.arange(len(known))), axis=1)
    chord, _ = cKDTree(centers[~known]).query(centers)
    return np.degrees(2 * np.arcsin(np.minimum(chord / 2, 1)))


def by_adwave(command, values, known, fwhm):
    """The map after heat on its known pixels, by the command."""
    with tempfile.TemporaryDirectory() as folder:
        source, result = Path(folder) / "map.fits", Path(folder) / "smooth.fits"
        masked = np.where(known, values, healpy.UNSEEN)
        healpy.write_map(source, masked, dtype=np.float64, nest=False)
        words = [command, "filter", source, "-o", result, "--fwhm", f"{fwhm}deg", "--preset", "suppress", "--quiet"]
        subprocess.run(words, check=True, capture_output=True)
        return healpy.read_map(result, dtype=np.float64)


def by_healpy(values, known, fwhm):
    """healpy's smoothing of a masked map, which takes hidden pixels for 0."""
    masked = np.where(known, values, healpy.UNSEEN)
    return healpy.smoothing(masked, fwhm=np.radians(fwhm))


def by_healpy_normalized(values, known, fwhm):
    """healpy's smoothing divided by that of the mask."""
    above = healpy.smoothing(np.where(known, values, 0.0), fwhm=np.radians(fwhm))
    below = healpy.smoothing(known.astype(float), fwhm=np.radians(fwhm))
    return above / below


WAYS = {
    "adwave": by_adwave,
    "healpy": lambda _, *given: by_healpy(*given),
    "normalized": lambda _, *given: by_healpy_normalized(*given),
}


def measure(command, nside, slope, seed, fwhm):
    """Errors in percent of each way on the whole sky, and of the masked map inside and at the mask."""
    values, truth = random_map(nside, slope, seed, fwhm)
    known = random_mask(nside, seed)
    inside = known & (distance_to_mask(nside, known) > fwhm)
    everywhere = np.ones_like(known)

    def error(found, where):
        if not where.any():
            return np.nan
        return 100 * np.sqrt(np.mean((found - truth)[where] ** 2)) / truth[everywhere].std()

    errors = {}
    for name, smooth in WAYS.items():
        whole, masked = smooth(command, values, everywhere, fwhm), smooth(command, values, known, fwhm)
        errors[name] = [error(whole, everywhere), error(masked, inside), error(masked, known & ~inside)]
    return errors


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--command", default="adwave", help="adwave's command")
    parser.add_argument("--nside", type=int, nargs="+", default=[64])
    parser.add_argument("--fwhm", type=float, nargs="+", default=[5, 10, 20, 30])
    parser.add_argument("--seeds", type=int, nargs=2, default=[0, 3], metavar=("FROM", "TO"))
    args = parser.parse_args()
    print("percent of the fluctuations, rms over slopes and seeds (largest in brackets)")
    print(f"{'nside':>5} {'FWHM':>5} {'':12} {'whole sky':>16} {'inside':>16} {'at the mask':>16}")
    for nside in args.nside:
        for fwhm in args.fwhm:
            cases = [measure(args.command, nside, slope, seed, fwhm) for slope in SLOPES for seed in range(*args.seeds)]
            for name in WAYS:
                rows = [case[name] for case in cases]
                mean, worst = np.sqrt(np.nanmean(np.square(rows), axis=0)), np.nanmax(rows, axis=0)
                cells = [f"{m:9.3f} ({w:.3f})" for m, w in zip(mean, worst, strict=True)]
                print(f"{nside:5d} {fwhm:5g} {name:12}", *[f"{cell:>16}" for cell in cells], flush=True)


if __name__ == "__main__":
    main()
