"""Calls that are wrong: a type checker is to complain of every line that ends in `# wrong`."""

import adwave as aw

shape = aw.sample("creature", vertices=2000)
f = shape.points[:, 2]

aw.decompose(shape, f, scales=[1, 2])  # wrong
aw.decompose(shape, opertor="walk")  # wrong
aw.decompose(shape, levels="8")  # wrong
aw.decompose(shape, levels=[1.0, 2.0])  # wrong
aw.decompose(shape, operator="surfce")  # wrong
aw.decompose(shape, fwmh=[1])  # wrong
aw.smooth(shape, f, sigma=2)  # wrong
aw.smooth(shape, f, steps="three")  # wrong
aw.filter(shape)  # wrong
aw.filter(shape, "smooth", constraints=aw.Constraints(border="banana"))  # wrong
aw.denoise(shape, creases="yes")  # wrong
aw.Widths(sigma=[1])  # wrong
aw.Operator("walk", knn=5)  # wrong
aw.render(shape, f, cmap="magma")  # wrong
aw.saliency(shape, weighting="loud")  # wrong
aw.simplify(shape, target_reduction=0.5)  # wrong
print(shape.no_such)  # wrong
