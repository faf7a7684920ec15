# SPDX-License-Identifier: Apache-2.0
"""The cascade in numpy, as a textbook writes it. Reads the input and the commands of peer.h."""

import sys
import time

import numpy as np


class Stage:
    """An extended Kalman filter that measures its first states."""

    def __init__(self, values, section, first):
        measurement_variance = values[section + ".measurement_variance"]
        self.x = np.array(first)
        self.P = np.diag(values[section + ".initial_variance"])
        self.Q = np.diag(values[section + ".process_variance"])
        self.R = np.diag(measurement_variance)
        self.H = np.eye(len(measurement_variance), 3)
        self.I = np.eye(3)

    def predict(self, x, J):
        self.x = x
        self.P = J @ self.P @ J.T + self.Q

    def update(self, z):
        S = self.H @ self.P @ self.H.T + self.R
        K = self.P @ self.H.T @ np.linalg.inv(S)
        self.x = self.x + K @ (z - self.H @ self.x)
        self.P = (self.I - K @ self.H) @ self.P


class Stage1:
    def __init__(self, values):
        self.values = values
        T, m0 = values["sample_time_s"][0], values["assumed_mass_kg"][0]
        px = T * T / m0 if values["motion.is_backward"][0] else 0
        self.A = np.array([[1, T, px], [0, 1, T / m0], [0, 0, 1]])
        self.stage = None

    def step(self, z):
        if self.stage is None:
            self.stage = Stage(self.values, "motion", [z, 0.0, 0.0])
        else:
            self.stage.predict(self.A @ self.stage.x, self.A)
        self.stage.update(np.array([z]))
        return self.stage.x

    def variances(self):
        return np.diag(self.stage.P)


class Cascade:
    def __init__(self, values):
        self.values = values
        self.T, self.m0 = values["sample_time_s"][0], values["assumed_mass_kg"][0]
        self.motion = Stage1(values)
        self.friction = self.mass = None

    def step(self, z):
        motion = self.motion.step(z)
        v, u = motion[1], motion[2]
        z_and_v = np.array([z, v])
        if self.friction is None:
            kv, m = self.values["friction.initial_Ns_m"][0], self.values["mass.initial_kg"][0]
            self.friction = Stage(self.values, "friction", [z, 0.0, kv])
            self.mass = Stage(self.values, "mass", [z, 0.0, m])
            self.friction.update(z_and_v)
        else:
            self.predict_friction(u)
            self.friction.update(z_and_v)
            self.predict_mass(u)
        self.mass.update(z_and_v)
        return np.array([motion[0], v, u, self.friction.x[2], self.mass.x[2]])

    def predict_friction(self, u):
        T, m0 = self.T, self.m0
        p, v, kv = self.friction.x
        d = 1 + T * kv / m0
        v_next = (v + T * u / m0) / d
        dv_dkv = -v_next * T / (m0 * d)
        J = np.array([[1, T / d, T * dv_dkv], [0, 1 / d, dv_dkv], [0, 0, 1]])
        self.friction.predict(np.array([p + T * v_next, v_next, kv]), J)

    def predict_mass(self, u):
        T, kv = self.T, self.friction.x[2]
        p, v, m = self.mass.x
        d = m + T * kv
        v_next = (m * v + T * u) / d
        dv_dm = T * (kv * v - u) / d**2
        J = np.array([[1, T * m / d, T * dv_dm], [0, m / d, dv_dm], [0, 0, 1]])
        self.mass.predict(np.array([p + T * v_next, v_next, m]), J)

    def variances(self):
        others = [self.friction.P[2, 2], self.mass.P[2, 2]]
        return np.concatenate([self.motion.variances(), others])


FILTERS = {"stage_1": Stage1, "cascade": Cascade}


def ns_per_sample(filter_type, values):
    positions_m = values["position_m"]
    start_ns = time.process_time_ns()
    stepped = filter_type(values)
    estimates = [stepped.step(z) for z in positions_m]
    return (time.process_time_ns() - start_ns) / len(estimates)


def write_estimates(filter_type, values, path):
    stepped = filter_type(values)
    with open(path, "w") as file:
        for z in values["position_m"]:
            row = [*stepped.step(z), *stepped.variances()]
            file.write(" ".join(repr(float(value)) for value in row) + "\n")


def main():
    with open(sys.argv[1]) as file:
        values = {name: [float(x) for x in rest] for name, *rest in map(str.split, file)}
    for line in sys.stdin:
        command, name, *path = line.split()
        if command == "time":
            print(ns_per_sample(FILTERS[name], values), flush=True)
        else:
            write_estimates(FILTERS[name], values, path[0])
            print("written", flush=True)


main()
