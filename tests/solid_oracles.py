"""Independent witnesses for slabs with solid layers: 4 x 4 matrices with many digits, and layer stiffnesses. They share no code with the package.

A stack is a list of layers from the near side on: a fluid (density, bulk modulus, thickness) or a solid (density, longitudinal speed,
shear speed, thickness).
"""

import mpmath as mp
import numpy as np


def _generator(rho, c_l, c_t, w, k):
    """d/dz of (p, X, q, T): p = -s_zz, X = -i w^2 u_x, q = w^2 u_z, T = -i s_xz."""
    rho, c_l, c_t = (mp.mpmathify(v) for v in (rho, c_l, c_t))
    modulus, mu = rho * c_l**2, rho * c_t**2
    lam, zeta = modulus - 2 * mu, 4 * mu * (1 - mu / modulus)
    m = mp.matrix(4, 4)
    m[0, 2], m[0, 3], m[1, 2], m[1, 3] = rho, -k, -k, w * w / mu
    m[2, 0], m[2, 1], m[3, 0], m[3, 1] = (
        -w * w / modulus,
        k * lam / modulus,
        k * lam / modulus,
        -rho + k * k * zeta / w**2,
    )
    return m


def _fluid_back(rho, K, d, w, k):
    """(p, q) of the near face from those of the far face."""
    rho, K = mp.mpmathify(rho), mp.mpmathify(K)
    kz2 = rho * (w * w / K - k * k / rho)
    kz = mp.sqrt(kz2)
    c, s = mp.cos(kz * d), mp.sin(kz * d) / kz if kz != 0 else mp.mpf(d)
    return mp.matrix([[c, -rho * s], [kz2 / rho * s, c]])


def _solid_back(rho, c_l, c_t, d, w, k):
    """exp(-N d) of the generator N, whose square has the eigenvalues -a^2 and -b^2 (Cayley and Hamilton)."""
    n = _generator(rho, c_l, c_t, w, k)
    square = n * n
    values = [k * k - (w / mp.mpmathify(c)) ** 2 for c in (c_l, c_t)]
    roots = [mp.sqrt(v) for v in values]
    out = mp.zeros(4)
    for i in (0, 1):
        projector = (square - values[1 - i] * mp.eye(4)) / (values[i] - values[1 - i])
        out += projector * (mp.cosh(roots[i] * d) * mp.eye(4) - n * (mp.sinh(roots[i] * d) / roots[i]))
    return out


def _between_fluids(m):
    """(p, q) in front of solids from (p, q) behind them, of their 4 x 4 matrix back: T = 0 on both faces."""
    out = mp.matrix(2, 2)
    for column, far in enumerate((0, 2)):
        X = -m[3, far] / m[3, 1]
        out[0, column], out[1, column] = m[0, far] + X * m[0, 1], m[2, far] + X * m[2, 1]
    return out


def plate_back(rho, c_l, c_t, d, w, k):
    """(p, q) in front of a plate from (p, q) behind it."""
    return _between_fluids(_solid_back(rho, c_l, c_t, d, w, k))


def _growth(layers, w, k):
    """Decades by which waves may grow over all layers and back."""
    slow = (layer[2] if len(layer) == 4 else np.sqrt(complex(layer[1] / layer[0])) for layer in layers)
    rates = (abs(k) + abs((w / complex(c)).imag) for c in slow)
    return sum(2 * 0.44 * rate * layer[-1] for rate, layer in zip(rates, layers, strict=True))


def response(layers, periods, before, after, frequency, kx, digits=50):
    """r and t of `periods` copies of layers between two fluids (density, bulk modulus).

    Behind may be a solid (density, longitudinal speed, shear speed): t is that of p = -s_zz.
    """
    w = 2 * np.pi * float(frequency)
    with mp.workdps(int(digits + 30 + _growth(layers, w, kx) * periods)):
        w, k = mp.mpf(w), mp.mpmathify(kx)
        made = {layer: (_solid_back if len(layer) == 4 else _fluid_back)(*layer, w, k) for layer in set(layers)}
        back, solids = mp.eye(2), None
        for layer in [*list(layers) * periods, None]:
            if layer is None and len(after) == 3:
                break
            if layer is not None and len(layer) == 4:
                solids = made[layer] if solids is None else solids * made[layer]
                continue
            if solids is not None:
                back, solids = back * _between_fluids(solids), None
            if layer is not None:
                back = back * made[layer]
        y1 = 1j * _outgoing(*before, w, k) / mp.mpmathify(before[0])
        if len(after) == 3:
            far_p, p, q = _in_front_of(after, mp.eye(4) if solids is None else solids, w, k)
        else:
            far_p, p, q = 1, 1, 1j * _outgoing(*after, w, k) / mp.mpmathify(after[0])
        p, q = back[0, 0] * p + back[0, 1] * q, back[1, 0] * p + back[1, 1] * q
        incident = (p + q / y1) / 2
        return complex((p - q / y1) / 2 / incident), complex(far_p / incident)


def _in_front_of(solid, solids, w, k):
    """p of the half-space of solid, and p and q of the fluid in front of the solids (their matrix back) that touch it."""
    rho, c_l, c_t = (mp.mpmathify(v) for v in solid)
    states = []
    for c, shear in ((c_l, 0), (c_t, 1)):
        kz = _outgoing(rho, rho * c * c, w, k)
        u_x, u_z = (-kz, k) if shear else (k, kz)
        mu, lam = rho * c_t**2, rho * (c_l**2 - 2 * c_t**2)
        s_zz, s_xz = 1j * ((lam + 2 * mu) * kz * u_z + lam * k * u_x), 1j * mu * (kz * u_x + k * u_z)
        states.append(mp.matrix([-s_zz, -1j * w * w * u_x, w * w * u_z, -1j * s_xz]))
    near = [solids * state for state in states]
    share = -near[0][3] / near[1][3] if near[1][3] != 0 else mp.mpf(0)
    p, q = (near[0][i] + share * near[1][i] for i in (0, 2))
    return states[0][0] + share * states[1][0], p, q


def _outgoing(rho, K, w, k):
    kz = mp.sqrt(mp.mpmathify(rho) * (w * w / mp.mpmathify(K) - k * k / mp.mpmathify(rho)))
    return -kz if mp.im(kz) < 0 or (mp.im(kz) == 0 and mp.re(kz) < 0) else kz


def by_stiffness(layers, water, frequency, kx):
    """r and t of solids alone in a fluid (density, sound speed), by layer stiffnesses put together one by one (Rokhlin and Wang 2002).

    In each layer four partial waves, each of size 1 on the face from which it decays, give displacements and stresses on both faces.
    """
    w = 2 * np.pi * frequency
    total = None
    for rho, c_l, c_t, d in layers:
        a, b = (np.sqrt(complex((w / c) ** 2 - kx**2)) for c in (c_l, c_t))
        a, b = (v if v.imag >= 0 else -v for v in (a, b))
        mu, lam = rho * c_t**2, rho * (c_l**2 - 2 * c_t**2)
        # potentials phi, psi: u = grad phi + (-d psi/dz, d psi/dx)
        u, s = np.empty((4, 4), complex), np.empty((4, 4), complex)
        for column, (kz, shear, down) in enumerate(((a, 0, 1), (b, 1, 1), (a, 0, -1), (b, 1, -1))):
            g = 1j * kz * down
            u_x, u_z = (-g, 1j * kx) if shear else (1j * kx, g)
            s_zz = (lam + 2 * mu) * g * u_z + lam * 1j * kx * u_x
            s_xz = mu * (g * u_x + 1j * kx * u_z)
            for row, z in ((0, 0.0), (2, d)):
                phase = np.exp(1j * kz * (z if down > 0 else d - z))
                u[row : row + 2, column] = np.array([u_x, u_z]) * phase
                s[row : row + 2, column] = np.array([s_xz, s_zz]) * phase
        K = s @ np.linalg.inv(u)
        if total is None:
            total = K
            continue
        A, B = total, K
        inner = np.linalg.inv(B[:2, :2] - A[2:, 2:])
        total = np.block([
            [A[:2, :2] + A[:2, 2:] @ inner @ A[2:, :2], -A[:2, 2:] @ inner @ B[:2, 2:]],
            [B[2:, :2] @ inner @ A[2:, :2], B[2:, 2:] - B[2:, :2] @ inner @ B[:2, 2:]],
        ])  # fmt: skip
    S = np.linalg.inv(total)[np.ix_([1, 3], [1, 3])]  # u_z on both faces from s_zz, without shear stress
    rho0, c0 = water
    y = 1j * np.sqrt(complex((w / c0) ** 2 - kx**2)) / rho0
    # u_z = -S p:  y (1 - r) = -w^2 (S11 (1 + r) + S12 t),  y t = -w^2 (S21 (1 + r) + S22 t)
    m = np.array([[w * w * S[0, 0] - y, w * w * S[0, 1]], [w * w * S[1, 0], w * w * S[1, 1] + y]])
    return np.linalg.solve(m, -np.array([y + w * w * S[0, 0], w * w * S[1, 0]]))
