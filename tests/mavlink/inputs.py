"""Sends external poses over pymavlink and reads their effect at the console, which is reached over MAVLink as well.

inputs.py CONNECTION SECONDS

Prints the answers of `mavlink` and `watch pose` as JSON; exit status 1 when the console stays silent.
"""

import json
import math
import os
import sys
import time

os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil  # noqa: E402

NAN = float("nan")
SHELL, RESPOND = 10, 2
ROLL_30 = [math.cos(math.pi / 12), math.sin(math.pi / 12), 0.0, 0.0]
NO_COVARIANCE = [NAN] * 21


def micros():
    return int(time.time() * 1e6)


def odometry(mav, x):
    """A level pose in ENU that looks north, its velocity along the body's axes."""
    north = [0.0, math.sqrt(0.5), math.sqrt(0.5), 0.0]
    mav.odometry_send(micros(), 4, 12, x, 2.0, 3.0, north, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0,
                      NO_COVARIANCE, NO_COVARIANCE, 0, 1, 100)


def vision(mav, x):
    mav.vision_position_estimate_send(micros(), x, -2.0, -3.0, math.radians(10), 0.0, 0.0, NO_COVARIANCE)


def mocap(mav, x):
    mav.att_pos_mocap_send(micros(), ROLL_30, x, 0.5, -0.5, NO_COVARIANCE)


class Console:
    """The vehicle's console by SERIAL_CONTROL."""

    def __init__(self, line, seconds):
        self.line, self.seconds = line, seconds

    def type(self, text):
        data = text.encode()
        self.line.mav.serial_control_send(SHELL, RESPOND, 0, 0, len(data), data.ljust(70, b"\0"))

    def until(self, enough, meanwhile=lambda: None):
        said, end = "", time.monotonic() + self.seconds
        while not enough(said):
            if time.monotonic() > end:
                raise SystemExit(f"the console says '{said}' and no more")
            meanwhile()
            message = self.line.recv_match(type="SERIAL_CONTROL", blocking=True, timeout=0.02)
            if message is not None:
                said += bytes(message.data[: message.count]).decode("ascii", "replace")
        return said

    def ask(self, command):
        self.type(command + "\r")
        return self.until(lambda said: said.endswith("\n> ") and command in said)

    def watch(self, group, rows, meanwhile):
        self.type(f"watch {group}\r")
        said = self.until(lambda said: said.count("\n") > rows + 3, meanwhile)
        self.type("\x03")
        self.until(lambda said: said.endswith("> "))
        return [row.split() for row in said.splitlines()]


def main() -> int:
    connection, seconds = sys.argv[1], float(sys.argv[2])
    # A computer aboard (MAV_COMP_ID_VISUAL_INERTIAL_ODOMETRY): another system's poses are refused.
    line = mavutil.mavlink_connection(connection, source_system=1, source_component=197, dialect="common", retries=30)
    line.wait_heartbeat(timeout=seconds)
    line.mav.heartbeat_send(6, 8, 0, 0, 0)
    console = Console(line, seconds)
    console.ask("version")
    said = {}
    for name, send in (("odometry", odometry), ("vision", vision), ("mocap", mocap)):
        said[name] = console.watch("pose", 3, lambda send=send: send(line.mav, 1.5))
        # Another message is another source, which comes once the one before has been silent for two seconds.
        time.sleep(2.5)
    # Not a number.
    vision(line.mav, NAN)
    # The counts are published at the task's next run.
    time.sleep(0.2)
    said["mavlink"] = console.ask("mavlink").splitlines()
    print(json.dumps(said))
    return 0


sys.exit(main())
