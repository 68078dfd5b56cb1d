"""Recordings of machines.py as tools of drives and loggers write them. Read by first_contact.py."""
import datetime
import json
import math

import numpy as np

RNG = np.random.default_rng(101)  # of the noise; first_contact.py seeds it anew
GAIN = ["--gain", "6.5"]


def text(columns, names=None, separator=",", decimal=".", formats=None, above=(), below=()):
    """Rows of the columns, which may hold texts."""
    lines = list(above) + ([separator.join(names)] if names else []) + list(below)
    kinds = formats or ["%.7g"] * len(columns)
    for row in zip(*columns):
        fields = [f % x if not isinstance(x, str) else x for f, x in zip(kinds, row)]
        lines.append(separator.join(f.replace(".", decimal) for f in fields))
    return "\n".join(lines) + "\n"


def noisy(values, sigma):
    return values + sigma * RNG.standard_normal(len(values))


def stepped(values, resolution):
    return np.floor(values / resolution) * resolution


# Layouts: each takes a motion and returns the files and the answers.


def plain(m):
    return {"run.csv": text([m.time, m.current, noisy(m.position, 2e-6), noisy(m.velocity, 2e-3)],
                            ["time_s", "motor_current_a", "position_m", "velocity_mps"])}, GAIN


def counts(m):
    return {"geber.csv": text([1e3 * m.time, m.current, np.floor(m.position * 8e6)],
                              ["Zeit [ms]", "Motorstrom [A]", "Geber [Ink]"], ";", ",")}, [
        *GAIN, "--column", "position=Geber [Ink]:um/8"]


def degrees(m):  # a pinion of 25 mm
    deg = np.degrees(m.position / 0.025)
    return {"axis.csv": text([m.time, m.current, noisy(deg, 5e-3)], ["t [s]", "iq [A]", "q [deg]"])}, [
        *GAIN, "--column", f"position=q [deg]:mm*{25 * math.pi / 180:.10f}"]


def per_minute(m):
    return {"log.csv": text(
        [m.time, m.current, 1e3 * noisy(m.position, 2e-6), 6e4 * noisy(m.velocity, 2e-3)],
        ["Time (s)", "Current (A)", "Position (mm)", "Speed (mm/min)"])}, GAIN


def german(m):
    return {"Fahrt.csv": text(
        [1e3 * m.time, 1e3 * noisy(m.position, 2e-6), 1e3 * noisy(m.velocity, 2e-3), m.current],
        ["Zeit [ms]", "Istposition [mm]", "Ist-Geschwindigkeit [mm/s]", "Motorstrom [A]"],
        ";", ",")}, GAIN


def wrong_sign(m):
    half = len(m.time) // 2
    part = lambda s, sign: text([m.time[s], sign * m.current[s], noisy(m.position[s], 2e-6)],
                                ["time_s", "current_A", "pos_m"])
    return {"a.csv": part(slice(0, half), -1), "b.csv": part(slice(half, None), -1)}, GAIN


def noisy_input(m):
    return {"noisy.csv": text([m.time, noisy(m.current, 0.05), noisy(m.position, 2e-6)],
                              ["time_s", "current_A", "position_m"])}, GAIN


def late(m):
    position = noisy(np.concatenate([[0.0], m.position[:-1]]), 2e-6)
    return {"late.csv": text([m.time, m.current, position],
                             ["time_s", "current_A", "position_m"])}, GAIN


def preamble(m):
    above = ["Rig 7, Axis 2", "Operator,N. N.", "Date,2026-03-16", "Firmware,1.2.3", "Comment,",
             "Samples,6000", ""]
    return {"rig.csv": text([m.time, 1e3 * noisy(m.position, 2e-6), m.current],
                            ["Time", "Position", "Current"], above=above, below=["s,mm,A"])}, GAIN


def headerless(m):
    return {"log.txt": text([m.time, m.current, 1e3 * noisy(m.position, 2e-6),
                             1e3 * noisy(m.velocity, 2e-3)], separator="\t")}, GAIN


def two_files(m):
    keep = slice(1500, None)
    force = text([m.time, 6.5 * m.current], ["time_s", "force_N"])
    motion = text([m.time[keep] - m.time[keep][0], noisy(m.position[keep], 2e-6),
                   noisy(m.velocity[keep], 2e-3)], ["t_s", "pos_m", "vel_mps"])
    return {"motion.csv": motion, "force.csv": force}, []


def twincat(m):
    slow = slice(0, None, 2)
    head = ["Name\tLog", "File\tC:\\log.csv", "Starttime of export\t1\tMontag\t15:56", "", "",
            "Name\tActCurrent\tName\tActPos\tName\tActVelo",
            "SymbolComment\t\tSymbolComment\t\tSymbolComment\t",
            "Data-Type\tREAL32\tData-Type\tREAL64\tData-Type\tREAL64",
            "SampleTime[ms]\t1\tSampleTime[ms]\t2\tSampleTime[ms]\t2",
            "SymbolName\tA\tSymbolName\tB\tSymbolName\tC",
            "Unit\tA (Current)\tUnit\tmm (Length)\tUnit\tmm/s (Velocity)", ""]
    rows = [["%g" % (1e3 * t), "%.7g" % i] for t, i in zip(m.time, m.current)]
    for k, (t, p, v) in enumerate(zip(m.time[slow], noisy(m.position, 2e-6)[slow],
                                      noisy(m.velocity, 2e-3)[slow])):
        rows[k] += ["%g" % (1e3 * t), "%.7g" % (1e3 * p), "%g" % (1e3 * t), "%.7g" % (1e3 * v)]
    lines = ["\t".join(r + [" "] * (6 - len(r))) for r in rows]
    return {"scope.csv": "\n".join(head + lines + ["EOF"]) + "\n"}, GAIN


def labview(m):
    above = ["Timestamp,2026-03-16 17:04:51,Timestamp,2026-03-16 17:04:51",
             "Interval,0.001,Interval,0.001", 'Channel name,"Force",Channel name,"Linear scale"',
             'Unit,"N",Unit,"mm"']
    n = np.arange(len(m.time))
    return {"daq.csv": "\ufeff" + text([n, 6.5 * m.current, n, 1e3 * noisy(m.position, 2e-6)],
                                       above=above)}, []


def configurator(m):  # a screw of 100 mm, 40 N at 100 %
    above = ["Axis1", "Number of sampling data,6000", "Sampling time interval(ms),1",
             "Time,Analog 1,Analog 2,Analog 3,Digital 1"]
    zero = np.zeros(len(m.time))
    return {"graph.csv": text(
        [1e3 * m.time, 600 * noisy(m.velocity, 2e-3), 16.25 * m.current, zero, zero + 2.5],
        ["ms", "Servo motor speed", "Torque", "Not selected", "INP"], above=above)}, [
        "--column", "velocity=Servo motor speed:m/s/600", "--column", "force=Torque:N*0.4"]


def cia_402(m):
    return {"pdo.csv": text(
        [1e3 * m.time, np.floor(m.position * 1e6), np.round(m.velocity * 1e4), np.round(
            162.5 * m.current)],
        ["time_ms", "0x6064", "0x606C", "0x6077"])}, [
        "--column", "position=0x6064:um", "--column", "velocity=0x606C:m/s/10000", "--column",
        "force=0x6077:N*0.04"]


def messy(m):
    begin = datetime.datetime(2026, 3, 16, 17, 4, 51)
    clock = [(begin + datetime.timedelta(seconds=float(t))).isoformat(timespec="milliseconds")
             for t in m.time]
    state = ["idle" if i % 7 else "" for i in range(len(clock))]
    temperature = ["%.1f" % (20 + 0.001 * i) if i % 50 == 0 else "NaN" for i in range(len(clock))]
    zero = np.zeros(len(m.time))
    return {"export.csv": text(
        [clock, noisy(m.position, 2e-6), m.current, state, temperature, zero, zero],
        ["Timestamp", "Position [m]", "Current [A]", "State", "Temp", "flag", "flag"])}, GAIN


def several_rates(m):
    position = ["%.7g" % p if i % 4 == 0 else "" for i, p in enumerate(noisy(m.position, 2e-6))]
    return {"rates.csv.gz": text([m.time, m.current, position],
                                 ["time_s", "current_A", "position_m"])}, GAIN


def pi_drive(m):
    return {"drive.csv": text(
        [m.time, m.demand, noisy(m.velocity, 2e-3), noisy(m.position, 2e-6), m.current],
        ["time_s", "set_velocity_mps", "velocity_mps", "position_m", "current_A"])}, GAIN


# The layouts below take all motions of a case. A third value holds what the tool may ask for, and the answer.


def joint_states(m):
    columns = [m.time, noisy(m.position, 1e-5), noisy(m.velocity, 2e-3), noisy(m.current, 0.1)]
    return {"joint.csv": text(columns, ["time", "q", "qd", "tau_meas"])}, []


def json_rows(m):
    columns = m.time, 1e3 * noisy(m.position, 2e-6), m.current
    rows = [{"t_s": round(t, 6), "state": "run", "x_mm": round(x, 4), "force_N": round(f, 4)}
            for t, x, f in zip(*(c.tolist() for c in columns))]
    return {"run.json": json.dumps(rows)}, []


def slow_log(m):  # one of a hundred samples; the force of an instant is between those held about it
    keep, before = slice(0, None, 100), np.append(m.current[:1], m.current[:-1])
    return {"slow.csv": text([m.time[keep], 0.5 * (before + m.current)[keep],
                              1e3 * noisy(m.position, 2e-5)[keep]],
                             ["Time [s]", "Force [N]", "Position [mm]"])}, []  # fmt: skip


def two_motors(left, right):
    columns = {"time_s": left.time}
    for side, m in (("left", left), ("right", right)):
        columns |= {f"{side}_position_m": noisy(m.position, 2e-6), f"{side}_current_A": m.current}
    return {"base.csv": text(columns.values(), list(columns))}, GAIN, ("--motor", ["--motor", "left"])


def beside_reference(m):
    return {"arm.csv": text([m.time, m.demand, noisy(m.position, 1e-5), m.current],
                            ["time_s", "q_des_rad", "q_rad", "torque_Nm"])}, []  # fmt: skip


def elevator(*motions):
    names = [f"{test}-{way}.csv" for test in ("quasistatic", "dynamic")
             for way in ("forward", "reverse")]  # fmt: skip
    one = lambda m: text([m.time, m.current, stepped(m.position, 1e-4), noisy(m.velocity, 5e-3)],
                         ["Timestamp", "Elevator/AppliedVolts", "Elevator/PositionMeters",
                          "Elevator/VelocityMetersPerSec"])  # fmt: skip
    return {name: one(m) for name, m in zip(names, motions)}, ["--gain", "1"]


def flywheel(m):  # a mean over 120 ms, as controllers make of encoders
    mean = np.convolve(np.pad(m.velocity, (119, 0)), np.ones(120) / 120, mode="valid")
    keep = slice(0, None, 20)
    return {"flywheel.csv": text([m.time[keep], m.current[keep], noisy(mean, 0.1)[keep] * 30 / math.pi],
                                 ["Timestamp", "Flywheel/AppliedVolts", "Flywheel/VelocityRPM"])}, [
        "--gain", "1"]  # fmt: skip


def arm(m):
    columns = [m.time, m.current, stepped(m.position, 2 * math.pi / 8192), noisy(m.velocity, 0.01)]
    names = ["Timestamp", "Arm/AppliedVolts", "Arm/PositionRad", "Arm/VelocityRadPerSec"]
    return {"arm.csv": text(columns, names)}, ["--gain", "1"]


def frames(m):  # a fieldbus of 4 ms, logged every millisecond
    held = lambda values: np.repeat(values[::4], 4)[: len(values)]
    return {"bus.csv": text([1e3 * m.time, held(m.current), held(1e3 * noisy(m.position, 2e-6))],
                            ["t_ms", "current_A", "position_mm"])}, GAIN  # fmt: skip


def spindle(m):
    columns = [m.time, m.current, noisy(m.position, 5e-5) / (2 * math.pi),
               noisy(m.velocity, 0.2) * 30 / math.pi]  # fmt: skip
    files = {"spindle.csv": text(columns, ["time_s", "phase_current_A", "spindle_turns", "spindle_rpm"])}
    return files, ["--gain", "0.11"], ("--column", ["--column", "position=spindle_turns:rev"])


def supply(m):
    """Of a battery that discharges; the volts at the motor are the input."""
    return 12.6 - 0.05 * m.time - 0.04 * np.abs(m.current)


def duty(m):
    columns = [m.time, m.current / supply(m), noisy(supply(m), 0.005), noisy(m.position, 1e-5)]
    names = ["time_s", "duty", "battery_voltage", "position_rad"]
    return {"drive.csv": text(columns, names)}, ["--gain", "1"]


def hobby(m):  # 12 V at a PWM of 255
    return {"serial.txt": text([np.round(1e3 * m.time), np.round(m.current * 255 / 12),
                                np.floor(m.position / (2 * math.pi) * 1200)], ["millis", "pwm", "ticks"])}, [
        "--gain", "12", "--column", "duty=pwm:1/255", "--column", "position=ticks:rev/1200"]  # fmt: skip


def no_times(m):
    columns = [np.degrees(noisy(m.position, 1e-5)), m.current]
    files = {"pendulum.csv": text(columns, ["angle [deg]", "torque [Nm]"])}
    return files, [], ("--rate", ["--rate", "1 kHz"])


def jittery(m):  # stamps of a host, not the instants of the samples
    late = np.clip(0.15 * RNG.standard_normal(len(m.time)), -0.45, 0.45) * (m.time[1] - m.time[0])
    return {"host.csv": text([1.7e9 + m.time + late, m.current, noisy(m.position, 2e-6)],
                             ["timestamp", "current_A", "position_m"],
                             formats=["%.6f", "%.7g", "%.7g"])}, GAIN  # fmt: skip


def changes(m):
    lines, last = ["Timestamp,Key,Value", "0.0,DS:enabled,true"], {}
    for t, volts, place in zip(m.time, m.current, stepped(m.position, 1e-4)):
        for key, value in (("/Drive/AppliedVolts", "%.6g" % volts),
                           ("/Drive/PositionMeters", "%.4f" % place)):  # fmt: skip
            if last.get(key) != value:
                lines.append(f"{t:.6f},{key},{value}")
                last[key] = value
    return {"list.csv": "\n".join(lines) + "\n"}, ["--gain", "1"]


def filtered_torque(m):
    keep, logged = 1.0 - math.exp(-(m.time[1] - m.time[0]) / 3e-3), [0.0]
    for u in m.current[:-1]:
        logged.append(logged[-1] + keep * (u - logged[-1]))
    return {"joint.csv": text([m.time, np.array(logged), noisy(m.position, 1e-5)],
                              ["time_s", "torque_Nm", "angle_rad"])}, []  # fmt: skip


def overflowing(m):  # 16 bits of 4096 counts a turn; a buffer that is written twice now and then
    n = len(m.time)
    rows = np.sort(np.append(np.arange(n), RNG.integers(0, n, n // 30)))
    counts = np.floor(m.position / (2 * math.pi) * 4096) % 65536
    columns = [m.time[rows], m.current[rows], counts[rows]]
    return {"wheel.csv": text(columns, ["time_s", "current_A", "enc"])}, [
        "--gain", "0.11", "--column", "position=enc:rev/4096"]  # fmt: skip


def both_encoders(m):  # one of ten samples
    columns = [m.time, noisy(m.demand, 1e-5), noisy(m.position, 1e-5), noisy(m.current, 0.1)]
    names = ["time_s", "motor_position_rad", "joint_position_rad", "joint_torque_Nm"]
    return {"joint.csv": text([c[::10] for c in columns], names)}, []
