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

# Time after which a request is typed again, s: MAVProxy repeats none whose every answer was lost.
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

        def until(words, ask=None):
            nonlocal said
            end = time.monotonic() + seconds
            next_ask = time.monotonic()
            while words not in said:
                if time.monotonic() > end:
                    proxy.kill()
                    raise SystemExit(f"MAVProxy does not say '{words}': {said}")
                if ask and time.monotonic() >= next_ask:
                    types(ask)
                    next_ask += AGAIN
                time.sleep(0.05)
                said += (proxy.stdout.read() or b"").decode("ascii", "replace")

        def types(command):
            proxy.stdin.write(f"{command}\n".encode())
            proxy.stdin.flush()

        until("Received")
        # Its `param set` looks for names in capitals alone; a file is taken as it is, and sent in capitals.
        with open(f"{path}.wanted", "w") as file:
            file.write(f"{name} {value}\n")
        types(f"param load {path}.wanted")
        until("Loaded ")
        types("long COMPONENT_ARM_DISARM 1")
        until("radio lost")
        if restarts:
            until("parameters stored")
            said = ""
            types("long PREFLIGHT_REBOOT_SHUTDOWN 1")
            until("CALIBRATING")
            # Nothing of before is left.
            until("Received", ask="param fetch")
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
