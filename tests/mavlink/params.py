"""What pymavlink reads of the parameters, before and after one was set and the vehicle has restarted.

params.py CONNECTION SECONDS NAME VALUE

Prints JSON: all parameters before and after.
"""

import json
import sys
import time

from pymavlink import mavutil

ME = mavutil.mavlink


class Vehicle:
    def __init__(self, connection: str, seconds: float):
        self.link = mavutil.mavlink_connection(connection, source_system=255)
        self.until = time.monotonic() + seconds
        self.awaited("HEARTBEAT")

    def awaited(self, kind, wanted=lambda message: True, seconds=None):
        """The next message of `kind` that is wanted; `None` where there is none within `seconds`."""
        end = min(self.until, time.monotonic() + seconds) if seconds else self.until
        while time.monotonic() < end:
            message = self.link.recv_match(type=kind, blocking=True, timeout=0.2)
            if message is not None and wanted(message):
                return message
        if seconds is None:
            raise SystemExit(f"pymavlink has waited in vain for {kind}")
        return None

    def text(self, words: str):
        self.awaited("STATUSTEXT", lambda message: words in message.text)

    def parameters(self) -> dict:
        found, count = {}, None
        self.link.mav.param_request_list_send(1, 1)
        while count is None or len(found) < count:
            message = self.awaited("PARAM_VALUE", seconds=10)
            if message is None:
                self.link.mav.param_request_list_send(1, 1)
                continue
            found[message.param_id], count = message.param_value, message.param_count
        return found


def main() -> None:
    connection, seconds, name, value = sys.argv[1], float(sys.argv[2]), sys.argv[3], float(sys.argv[4])
    vehicle = Vehicle(connection, seconds)
    before = vehicle.parameters()
    vehicle.link.mav.param_set_send(1, 1, name.encode(), value, ME.MAV_PARAM_TYPE_REAL32)
    vehicle.awaited("PARAM_VALUE", lambda message: message.param_id == name and message.param_value == value)
    vehicle.text("parameters stored")
    vehicle.link.mav.command_long_send(1, 1, ME.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 0, 1, 0, 0, 0, 0, 0, 0)
    # The first text of a start.
    vehicle.text("CALIBRATING")
    print(json.dumps({"before": before, "after": vehicle.parameters()}))


main()
