"""Signs as pymavlink does, against a vehicle whose key is in a file.

signing.py CONNECTION KEYFILE

Reads signed telemetry, sets a parameter, is refused unsigned, with another key and with what was recorded, and again after
a restart of the vehicle. Prints one JSON object; exit status 1 where something was not so.
"""

import json
import os
import sys
import time

os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil  # noqa: E402

WAIT = 20.0
failures = []


def check(holds, what):
    if not holds:
        failures.append(what)


def heard(line, kind, seconds=WAIT):
    """The next message of `kind`; heartbeats are sent meanwhile, as stations do."""
    end, beat = time.monotonic() + seconds, 0.0
    while time.monotonic() < end:
        if time.monotonic() > beat:
            line.mav.heartbeat_send(6, 8, 0, 0, 0)
            beat = time.monotonic() + 1.0
        message = line.recv_match(blocking=True, timeout=0.2)
        if message is not None and message.get_type() == kind:
            return message
    return None


def value(line, name=b"infill", seconds=WAIT):
    """Asks each second, as stations do: after a restart of the vehicle the first question is older than its time."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        line.mav.param_request_read_send(1, 1, name, -1)
        answer = heard(line, "PARAM_VALUE", 1.0)
        if answer is not None:
            return answer
    return None


def main() -> int:
    with open(sys.argv[2], encoding="ascii") as file:
        key = bytes.fromhex(file.read().strip())
    line = mavutil.mavlink_connection(sys.argv[1], source_system=255, dialect="common", retries=30)
    # Unsigned: nothing but silence, though frames arrive.
    check(line.recv_match(blocking=True, timeout=WAIT) is not None, "nothing arrives")
    check(value(line, seconds=2.0) is None, "an unsigned request was answered")
    line.setup_signing(bytes(32), sign_outgoing=True, allow_unsigned_callback=lambda *_: True)
    check(value(line, seconds=2.0) is None, "a request signed with another key was answered")

    line.setup_signing(key, sign_outgoing=True, allow_unsigned_callback=None)
    recorded = []
    write = line.write

    def record(data):
        recorded.append(bytes(data))
        return write(data)

    line.write = record
    first = heard(line, "ATTITUDE")
    check(first is not None and first.get_signed(), f"no signed telemetry: {first}")
    asked = value(line)
    check(asked is not None and asked.get_signed(), f"a signed request was not answered: {asked}")
    line.mav.param_set_send(1, 1, b"infill", 8.0, 9)
    sent = heard(line, "PARAM_VALUE")
    check(sent is not None and sent.param_value == 8.0, f"not set: {sent}")
    stored = heard(line, "STATUSTEXT")
    while stored is not None and not stored.text.startswith("parameters stored"):
        stored = heard(line, "STATUSTEXT")
    check(stored is not None, "not stored")
    line.mav.param_set_send(1, 1, b"infill", 9.0, 9)
    sent = heard(line, "PARAM_VALUE")
    check(sent is not None and sent.param_value == 9.0, f"not set: {sent}")
    # What was recorded, again: the first value must not come back.
    played = list(recorded)
    for frame in played:
        write(frame)
    asked = value(line)
    check(asked is not None and asked.param_value == 9.0, f"replayed: {asked}")
    check(heard_refusal(line), "no text about what was refused")

    # After a restart that another value survives. The vehicle's time starts ahead: pymavlink follows it.
    time.sleep(2.0)
    line.mav.command_long_send(1, 1, 246, 0, 1, 0, 0, 0, 0, 0, 0)
    ack = heard(line, "COMMAND_ACK")
    check(ack is not None and ack.result == 0, f"restart: {ack}")
    time.sleep(2.0)
    for frame in played:
        write(frame)
    asked = value(line)
    check(asked is not None and asked.param_value == 9.0, f"replayed after a restart: {asked}")
    signing = line.mav.signing
    print(json.dumps({"good": signing.goodsig_count, "bad": signing.badsig_count, "recorded": len(played)}))
    for failure in failures:
        print(failure, file=sys.stderr)
    return 1 if failures else 0


def heard_refusal(line):
    end = time.monotonic() + WAIT
    while time.monotonic() < end:
        text = heard(line, "STATUSTEXT", end - time.monotonic())
        if text is not None and text.text.startswith("refused: "):
            return True
    return False


sys.exit(main())
