"""Listens on a pymavlink connection until each wanted message has come so many times; prints them as one JSON object.

listen.py CONNECTION SECONDS COUNT MESSAGE...

It sends a ground station's heartbeat each second, as ground stations do. Exit status 1 when a message stays away for
SECONDS of wall time.
"""

import json
import os
import sys
import time

os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil  # noqa: E402


def main() -> int:
    connection, seconds, count, wanted = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), sys.argv[4:]
    # Over TCP the listener is there before the board is.
    line = mavutil.mavlink_connection(connection, source_system=255, dialect="common", retries=30)
    seen = {name: [] for name in wanted}
    end, beat = time.monotonic() + seconds, 0.0
    while any(len(messages) < count for messages in seen.values()):
        now = time.monotonic()
        if now > end:
            print({name: len(messages) for name, messages in seen.items()}, file=sys.stderr)
            return 1
        if now > beat:
            # An answer needs the vehicle's address, which its first message brings.
            if connection.startswith("tcp") or any(seen.values()):
                line.mav.heartbeat_send(
                    mavutil.mavlink.MAV_TYPE_GCS, mavutil.mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0
                )
            beat = now + 1.0
        message = line.recv_match(type=wanted, blocking=True, timeout=1)
        if message is not None:
            fields = message.to_dict()
            fields["system"] = message.get_srcSystem()
            seen[message.get_type()].append(fields)
    print(json.dumps({"messages": seen, "bad": line.mav.total_receive_errors, "lost": line.mav_loss}))
    return 0


sys.exit(main())
