name = "planar-three-body"
title = "planar circular restricted three-body problem"
state = "x y vx vy"
parameters = "mu"
first_integral_name = "Jacobi constant"


def squares(x, y, mu):
    return (x + mu) ** 2 + y**2, (x + mu - 1) ** 2 + y**2


def field(x, y, vx, vy, mu):
    r1, r2 = squares(x, y, mu)
    larger, smaller = (1 - mu) * r1**-1.5, mu * r2**-1.5
    return (
        vx,
        vy,
        x + 2 * vy - larger * (x + mu) - smaller * (x + mu - 1),
        y - 2 * vx - (larger + smaller) * y,
    )


def first_integral(x, y, vx, vy, mu):
    r1, r2 = squares(x, y, mu)
    return x**2 + y**2 + 2 * ((1 - mu) * r1**-0.5 + mu * r2**-0.5) - (vx**2 + vy**2)
