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
    lost, last = 0, None
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
        message = line.recv_match(blocking=True, timeout=1)
        if message is None or message.get_type() == "BAD_DATA":
            continue
        # Of the frame itself: pymavlink's own count takes the vehicle's own messages, which it does not know, for gaps.
        sequence = message.get_msgbuf()[4]
        lost += 0 if last is None else (sequence - last - 1) % 256
        last = sequence
        if message.get_type() in wanted:
            fields = message.to_dict()
            fields["system"] = message.get_srcSystem()
            seen[message.get_type()].append(fields)
    print(json.dumps({"messages": seen, "bad": line.mav.total_receive_errors, "lost": lost}))
    return 0


sys.exit(main())
