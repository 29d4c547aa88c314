"""Gives commands over pymavlink, one after the other, each until it has the wanted result; prints what was answered.

obey.py CONNECTION SECONDS JSON, with a list of [command, [parameters], wanted result].

Exit status 1 when a result stays away for SECONDS of wall time. Results that were not final are left out.
"""

import json
import os
import sys
import time

os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil  # noqa: E402

IN_PROGRESS = mavutil.mavlink.MAV_RESULT_IN_PROGRESS


def main() -> int:
    connection, seconds, steps = sys.argv[1], float(sys.argv[2]), json.loads(sys.argv[3])
    line = mavutil.mavlink_connection(connection, source_system=255, dialect="common", retries=30)
    line.wait_heartbeat(timeout=seconds)
    texts, answers = [], []
    for command, params, wanted in steps:
        results, end, again = [], time.monotonic() + seconds, 0.0
        while not results or results[-1] != wanted:
            now = time.monotonic()
            if now > end:
                print(f"{command} {params}: {results}, not {wanted}; {texts}", file=sys.stderr)
                return 1
            if now > again:
                line.mav.heartbeat_send(6, 8, 0, 0, 0)
                line.mav.command_long_send(1, 1, command, 0, *(params + [0] * (7 - len(params))))
                again = now + 0.3
            message = line.recv_match(type=["COMMAND_ACK", "STATUSTEXT"], blocking=True, timeout=0.1)
            if message is None:
                continue
            if message.get_type() == "STATUSTEXT":
                texts.append(message.text)
            elif message.command == command and message.result != IN_PROGRESS:
                results.append(message.result)
            elif message.command == command:
                # It is under way: asked again it would be begun again.
                again = end
        answers.append(results)
    # What is said of the last one.
    quiet = time.monotonic() + 1.0
    while time.monotonic() < quiet:
        message = line.recv_match(type="STATUSTEXT", blocking=True, timeout=0.1)
        if message is not None:
            texts.append(message.text)
    print(json.dumps({"answers": answers, "texts": texts}))
    return 0


sys.exit(main())
