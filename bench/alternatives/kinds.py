"""What the cases of the independent generator lack, and which names count for it.

`right` are the names in the catalogue for this physics, `related` those of its nearest relatives: an
effect that is the same to first order (a lag and a dead time), or the curve over the same variable.
Everything else that is claimed is a wrong structure.
"""
import dataclasses

import numpy as np

TIMING = frozenset({"dead_time", "drive_lag", "position.delay", "velocity.delay", "position.lag",
                    "velocity.lag"})  # fmt: skip
OVER_SPEED = frozenset({"force_over_velocity", "friction_over_velocity"})
OVER_STROKE = frozenset({"force_over_position"})
FRICTION_OVER_STROKE = frozenset({"friction_over_position"})


@dataclasses.dataclass(frozen=True)
class Kind:
    """A law. `law(machine, strength, shape, force)` is the fields of the machine that make it, with
    `shape` random numbers of 0 to 1 and `force` the force scale of the machine in N. `start` is the
    strength from which the calibration begins, in `force` where it is a force. `secret` is the part
    of the base model that the axis file leaves out."""

    meaning: str
    right: frozenset
    related: frozenset
    law: object
    start: float = 0.05
    is_force: bool = True
    setups: tuple = ("servo", "levels")
    secret: str = ""
    most: float = 0.2  # strength, in `force` where it is one
    power: float = 1.0  # of the strength, to which the missing force is proportional

    @property
    def counts(self):
        return self.right | self.related


def between(low, high, u):
    return low * (high / low) ** u


KINDS = {
    "coulomb": Kind(
        "dry friction that turns round over a finite speed, undeclared",
        frozenset({"coulomb_friction"}), frozenset({"dahl_friction"}) | OVER_SPEED,
        lambda m, s, u, f: {"coulomb": s, "creep": between(1e-4, 2e-3, u[0])}, secret="F_c"),
    "gravity": Kind(
        "a constant force, undeclared", frozenset({"constant_force", "directional_friction"}),
        OVER_SPEED | OVER_STROKE, lambda m, s, u, f: {"offset": s}, secret="F_0"),
    "drag": Kind(
        "drag by a power of 1.6 to 2.5 of the speed", frozenset({"quadratic_drag"}), OVER_SPEED,
        lambda m, s, u, f: {"drag": s, "drag_exponent": 1.6 + 0.9 * u[0]},
        most=0.3),
    "directional": Kind(
        "viscous friction that differs by direction", frozenset({"directional_friction"}), OVER_SPEED,
        lambda m, s, u, f: {"directional": s * (1 if u[0] < 0.5 else -1)}, most=0.5),
    "stribeck": Kind(
        "Stribeck friction with an exponent of 0.5, 1.5 or 2", frozenset({"stribeck_friction"}),
        OVER_SPEED, lambda m, s, u, f: {"stribeck": s, "stribeck_speed": between(0.02, 0.15, u[0]),
                                        "stribeck_exponent": (0.5, 1.5, 2.0)[int(3 * u[1])]}),
    "stroke_friction": Kind(
        "dry friction that rises from one level to another along the stroke",
        frozenset({"position_friction"}), FRICTION_OVER_STROKE | {"friction_bump"},
        lambda m, s, u, f: {"stroke_friction": s, "stroke_at": 0.2 * (u[0] - 0.5),
                            "stroke_width": between(0.05, 0.3, u[1]), "coulomb": m.coulomb + s},
        setups=("servo",)),
    "bump": Kind(
        "a raised cosine of dry friction at one place", frozenset({"friction_bump"}),
        FRICTION_OVER_STROKE | {"position_friction"},
        lambda m, s, u, f: {"bump": s, "bump_at": 0.3 * (u[0] - 0.5),
                            "bump_width": between(0.02, 0.1, u[1])}, setups=("servo",)),
    "load": Kind(
        "dry friction by the drive force, rounded at zero", frozenset({"load_friction"}),
        frozenset({"quadratic_load_friction", "stribeck_load_friction"}),
        lambda m, s, u, f: {"load": s}, is_force=False, most=0.9),
    "presliding": Kind(
        "dry friction with a bristle (LuGre)", frozenset({"dahl_friction"}),
        frozenset({"second_dahl_friction"}),
        lambda m, s, u, f: {"bristle": s}, start=3e-4, is_force=False, most=0.02),
    "spring": Kind(
        "a spring that stiffens", frozenset({"stroke_spring"}), OVER_STROKE,
        lambda m, s, u, f: {"spring": s, "spring_length": between(0.25, 0.8, u[0])}, 0.1,
        setups=("servo",), most=2.0),
    "ripple": Kind(
        "a ripple with flat tops along the stroke", frozenset({"periodic_force"}), OVER_STROKE,
        lambda m, s, u, f: {"ripple": s, "ripple_period": between(0.015, 0.08, u[0]),
                            "ripple_phase": 6.28 * u[1]}, setups=("servo",)),
    "payload": Kind(
        "more mass than declared and not to be fitted", frozenset({"added_mass", "M"}),
        frozenset({"position.gain", "velocity.gain"}),  # the same where one signal is recorded
        lambda m, s, u, f: {"mass": m.mass * (1.0 + s)}, is_force=False, secret="M", most=2.0),
    "elastic": Kind(
        "a part of the mass on a spring, beyond what is guided", frozenset({"elastic_mode"}),
        frozenset({"soft_transmission", "compliance", "backlash"}),
        lambda m, s, u, f: {"motor_share": 1.0 - s, "guided": 1.0,
                            **coupled(m, s, between(12.0, 30.0, u[0]), 0.03)},
        0.2, is_force=False, setups=("servo",), most=0.7),
    "backlash": Kind(
        "a gap between motor and load", frozenset({"backlash"}),
        frozenset({"soft_transmission", "compliance", "elastic_mode"}),
        lambda m, s, u, f: {"motor_share": 0.5, "gap": s, **coupled(m, 0.5, 60.0, 0.2)},
        1e-4, is_force=False, setups=("servo",), most=5e-3),
    "belt": Kind(
        "a soft belt to a load whose guide rubs", frozenset({"compliance"}),
        frozenset({"soft_transmission", "backlash", "elastic_mode"}),
        lambda m, s, u, f: {"motor_share": 0.3 + 0.5 * u[0],
                            **coupled(m, 0.7 - 0.5 * u[0], between(20.0, 80.0, u[1]) / np.sqrt(s), 0.05)},
        0.2, is_force=False, setups=("servo",), most=4.0),
    "lag": Kind(
        "a drive that follows with a lag", frozenset({"drive_lag"}), TIMING,
        lambda m, s, u, f: {"lag": s}, 2e-3, is_force=False, most=0.03),
    "late": Kind(
        "a drive that acts late", frozenset({"dead_time"}), TIMING,
        lambda m, s, u, f: {"dead_time": s}, 2e-3, is_force=False, most=0.03),
    "saturation": Kind(
        "a force that saturates smoothly",
        frozenset({"force_droop"}), frozenset(),
        lambda m, s, u, f: {"saturation": s / f}, 0.5, is_force=False, most=2.0, power=2.0),
    "fade": Kind(
        "a motor that loses force as it warms up", frozenset({"torque_fade"}), frozenset(),
        lambda m, s, u, f: {"fade": s, "fade_time": between(2.0, 10.0, u[0])}, 0.1, is_force=False,
        most=0.9),
    "warming": Kind(
        "dry friction that falls as it warms up", frozenset({"warming_friction"}),
        frozenset({"running_in_friction", "warming_grease", "force_over_time"}),
        lambda m, s, u, f: {"warming": s, "warming_time": between(1.0, 5.0, u[0])}, 0.3,
        is_force=False, most=0.95),
    "disturbance": Kind(
        "coloured force noise", frozenset(), frozenset(),
        lambda m, s, u, f: {"disturbance": s, "disturbance_corner": between(0.5, 15.0, u[0])}, 0.01),
}  # fmt: skip

# Several at once, each by itself as visible as a single one; "several" are many small ones.
PAIRS = (("stribeck", "ripple"), ("drag", "bump"), ("load", "directional"), ("coulomb", "late"),
         ("spring", "stribeck"), ("ripple", "stroke_friction"), ("fade", "drag"),
         ("gravity", "coulomb"))  # fmt: skip
SEVERAL = ("directional", "stribeck", "ripple", "bump")


def coupled(machine, share, frequency, ratio):
    """Stiffness and damping between a motor and a load with this share of the mass, which swings
    with `frequency` in Hz where the motor is held, damped by `ratio`."""
    w = 2 * np.pi * frequency
    return {"stiffness": share * machine.mass * w * w, "damping": 2 * ratio * w * share * machine.mass}
