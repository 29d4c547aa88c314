"""Runs MAVProxy without a terminal: it fetches all parameters, sets one, and saves what it has; it is refused arming.

proxy.py MASTER SECONDS NAME VALUE [restart]: with a restart before it saves

Prints JSON: the parameters in its file, and what it said.
"""

import json
import os
import subprocess
import sys
import tempfile
import time

# Time after which a command is typed again, s: MAVProxy repeats none whose answer was lost, sets a parameter three times
# within three seconds of its own clock alone, and drops what else arrives meanwhile. A busy machine's board is slower.
AGAIN = 30.0


def main() -> int:
    master, seconds, name, value = sys.argv[1], float(sys.argv[2]), sys.argv[3], sys.argv[4]
    restarts = sys.argv[5:] == ["restart"]
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "saved.parm")
        proxy = subprocess.Popen(
            [sys.executable, os.path.join(os.path.dirname(sys.executable), "mavproxy.py"), f"--master={master}",
             "--default-modules=param,cmdlong", "--mav20", "--no-state"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, cwd=folder)
        os.set_blocking(proxy.stdout.fileno(), False)
        said = ""

        def until(words, command=None):
            nonlocal said
            end = time.monotonic() + seconds
            next_time = time.monotonic()
            while words not in said:
                if time.monotonic() > end:
                    proxy.kill()
                    raise SystemExit(f"MAVProxy does not say '{words}': {said}")
                if command and time.monotonic() >= next_time:
                    types(command)
                    next_time += AGAIN
                time.sleep(0.05)
                said += (proxy.stdout.read() or b"").decode("ascii", "replace")

        def types(command):
            proxy.stdin.write(f"{command}\n".encode())
            proxy.stdin.flush()

        until("Received")
        # Its `param set` looks for names in capitals alone; a file is taken as it is, and sent in capitals.
        with open(f"{path}.wanted", "w") as file:
            file.write(f"{name} {value}\n")
        # Forced: also what it has is sent, so that a lost answer comes again.
        until("parameters stored", f"param forceload {path}.wanted")
        until("radio lost", "long COMPONENT_ARM_DISARM 1")
        if restarts:
            said = ""
            until("CALIBRATING", "long PREFLIGHT_REBOOT_SHUTDOWN 1")
            # Nothing of before is left.
            until("Received", "param fetch")
        types(f"param save {path}")
        until("Saved ")
        proxy.stdin.close()
        proxy.terminate()
        proxy.wait()
        with open(path) as file:
            rows = [line.split() for line in file]
    print(json.dumps({"params": {row[0]: float(row[1]) for row in rows}, "said": said}))
    return 0


sys.exit(main())
