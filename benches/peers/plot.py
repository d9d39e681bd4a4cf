"""Cost against n and against J, as a picture."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def draw(cost, path):
    # Equal figures give an equal file.
    matplotlib.rcParams["svg.hashsalt"] = "adwave"
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    n = [line["n"] for line in cost["against_n"]]
    t = [line["median"] for line in cost["against_n"]]
    left.loglog(n, t, "o-", label="adwave, J = 8")
    middle = len(n) // 2
    left.loglog(n, [t[middle] * k / n[middle] for k in n], ":", color="gray", label="∝ n")
    left.set(xlabel="vertices", ylabel="seconds", title="all bands of xyz")
    levels = [line["levels"] for line in cost["against_levels"]]
    t = [line["median"] for line in cost["against_levels"]]
    right.semilogy(levels, t, "o-", label="adwave")
    powers = [cost["product"]["median"] * 2 ** (j - 1) for j in levels]
    right.semilogy(levels, powers, "--", color="tab:red", label="powers (one product × steps)")
    right.semilogy(levels, [t[13] * 2 ** ((j - 14) / 2) for j in levels], ":", color="gray", label="∝ √2 a level")
    right.set(xlabel="levels J", title=f"all bands of xyz, {cost['n']:,} vertices", xticks=range(2, 21, 2))
    for axes in (left, right):
        axes.grid(alpha=0.3)
        axes.legend()
    figure.savefig(path, metadata={"Date": None})
