"""Seawing (Zhang, Yu, Zhang, Zhang 2013) in six degrees of freedom, written from the paper's equations in momenta and a
rotation matrix, apart from the program. Run as a script it prints the table that the program's own test reads."""

import numpy as np
from scipy.integrate import solve_ivp

G, RHO = 9.81, 1025.0
M_RB, M_P, M_DISPLACED = 54.28, 11.0, 65.28
R_RB = np.array([-0.0814, 0.0, 0.0032])
RADIUS = 0.014
I_RB, I_P = np.diag([0.60, 15.27, 15.32]), np.diag([0.02, 10.16, 0.17])
M_A, I_A = np.diag([1.48, 49.58, 65.92]), np.diag([0.53, 7.88, 10.18])
C_A = np.zeros((3, 3))
C_A[1, 2], C_A[2, 1] = 2.57, 3.61
KD0, KD, KBETA, KL0, KL = 7.19, 386.29, -115.65, -0.36, 440.99
KMR, KM0, KM, KMY = -58.27, 0.28, -65.84, 34.10
KP, KQ, KR = -19.83, -205.64, -389.30

# Gamma to port; the place of the moving mass; ballast at the centre of buoyancy.
GAMMA, R_P1, M_B = np.radians(45.0), 0.4216, 0.3
# A full turn takes 1630 s.
TIMES = np.linspace(0.0, 1640.0, 21)
START = dict(pitch=-0.5755, v=(0.4728, 0.0, 0.0120), depth=10.0)
COLUMNS = "time_s,north_m,east_m,depth_m,roll_rad,pitch_rad,heading_rad,v1_m_s,v2_m_s,v3_m_s,p_rad_s,q_rad_s,r_rad_s"


def hat(a):
    """The matrix of a cross product."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def inertia():
    """Masses and added masses, and the first moment of the masses."""
    c, s = np.cos(GAMMA), np.sin(GAMMA)
    turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    r_p = np.array([R_P1, -RADIUS * s, RADIUS * c])
    mass = M_RB + M_P + M_B
    coupling = C_A - M_RB * hat(R_RB) - M_P * hat(r_p)
    rotation = (
        I_A + I_RB + turn @ I_P @ turn.T - M_P * hat(r_p) @ hat(r_p) - M_RB * hat(R_RB) @ hat(R_RB)
    )
    whole = np.block([[M_A + mass * np.eye(3), coupling], [coupling.T, rotation]])
    return whole, M_RB * R_RB + M_P * r_p


def water(v, rates):
    """Force and moment of the water in body axes."""
    speed2 = v @ v
    alpha, beta = np.arctan2(v[2], v[0]), np.arcsin(v[1] / np.sqrt(speed2))
    ca, sa, cb, sb = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
    to_body = np.array([[ca * cb, -ca * sb, -sa], [sb, cb, 0.0], [sa * cb, -sa * sb, ca]])
    force = np.array([-(KD0 + KD * alpha**2), KBETA * beta, -(KL0 + KL * alpha)]) * speed2
    moment = (
        np.array([KMR * beta + KP * rates[0], KM0 + KM * alpha + KQ * rates[1], KMY * beta + KR * rates[2]])
        * speed2
    )
    return to_body @ force, to_body @ moment


def fly(times=TIMES):
    """Carries momenta, rotation matrix and position; returns rows as COLUMNS names them."""
    whole, first = inertia()
    inverse = np.linalg.inv(whole)
    net = M_RB + M_P + M_B - M_DISPLACED

    def rates_of(_, y):
        momentum, angular, rotation = y[0:3], y[3:6], y[6:15].reshape(3, 3)
        motion = inverse @ y[0:6]
        v, om = motion[:3], motion[3:]
        down = rotation[2]
        force, moment = water(v, om)
        return np.concatenate([
            np.cross(momentum, om) + net * G * down + force,
            np.cross(angular, om) + np.cross(momentum, v) + G * np.cross(first, down) + moment,
            (rotation @ hat(om)).ravel(),
            rotation @ v,
        ])

    c, s = np.cos(START["pitch"]), np.sin(START["pitch"])
    rotation = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    momenta = whole @ np.concatenate([START["v"], np.zeros(3)])
    y0 = np.concatenate([momenta, rotation.ravel(), [0.0, 0.0, START["depth"]]])
    solution = solve_ivp(rates_of, (times[0], times[-1]), y0, "DOP853", times, rtol=1e-13, atol=1e-14)
    rows, heading = [], 0.0
    for t, y in zip(solution.t, solution.y.T):
        rotation, motion = y[6:15].reshape(3, 3), inverse @ y[0:6]
        roll, pitch = np.arctan2(rotation[2, 1], rotation[2, 2]), -np.arcsin(rotation[2, 0])
        within = np.arctan2(rotation[1, 0], rotation[0, 0])
        # Continuous: from one row to the next it turns by less than half a circle.
        heading += (within - heading + np.pi) % (2 * np.pi) - np.pi
        rows.append([t, *y[15:18], roll, pitch, heading, *motion])
    return np.array(rows)


if __name__ == "__main__":
    print(COLUMNS)
    for row in fly():
        print(",".join(repr(float(value)) for value in row))
