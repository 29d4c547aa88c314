"""What MAVSDK, by its own plugins, has heard of and done with a vehicle.

sdk.py CONNECTION SECONDS (stands|restarts|flies)

stands: without a transmitter. Prints JSON: telemetry, all parameters, what became of one that was set and one that cannot
be, of arming, of the gripper, and what its shell was answered. restarts: the same, and all parameters after a restart.
flies: what became of arming, from before the pilot turns his switch on, and of the gripper in the air.
"""

import json
import sys
import time

from mavsdk import ComponentType, Configuration, Mavsdk, log_subscribe
from mavsdk.plugins.action.action import Action, ActionError
from mavsdk.plugins.gripper.gripper import Gripper, GripperError
from mavsdk.plugins.param.param import Param, ParamError
from mavsdk.plugins.shell.shell import Device, Shell, ShellError
from mavsdk.plugins.telemetry.telemetry import Telemetry


# Seconds after which an unanswered line is typed again.
AGAIN = 8


def tried(call, refusal, *args):
    try:
        return call(*args).name
    except refusal as why:
        return why.result.name


def soon(what, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = what()
        if value is not None:
            return value
        time.sleep(0.05)
    return None


def waited(what, seconds, so_far):
    value = soon(what, seconds)
    if value is None:
        raise SystemExit(f"MAVSDK has waited in vain: {so_far}")
    return value


def all_params(param):
    everything = param.get_all_params()
    others = len(everything.int_params) + len(everything.custom_params)
    return {p.name: p.value for p in everything.float_params}, others


def fly(system, telemetry, texts, seconds):
    """Arms as soon as it may, grabs and lets go in the air; the pilot flies."""
    action, gripper = Action(system), Gripper(system)
    arms, end = [], time.monotonic() + seconds
    while arms[-1:] != ["SUCCESS"] and time.monotonic() < end:
        arms.append(tried(action.arm, ActionError))
    grabs = []
    while grabs[-1:] != ["SUCCESS"] and time.monotonic() < end:
        grabs.append(tried(gripper.grab, GripperError, 1))
    released = tried(gripper.release, GripperError, 1)
    # One that was sent again may still be under way; the text follows the answer.
    disarmed, why = None, None
    while why is None and time.monotonic() < end:
        disarmed = tried(action.disarm, ActionError)
        why = soon(lambda: any("flying" in text for text in texts) or None, 1)
    return {"arms": arms, "grabs": grabs, "release": released, "armed": telemetry.armed(), "disarm": disarmed}


def main():
    log_subscribe(lambda *_: True)
    seconds = float(sys.argv[2])
    sdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
    sdk.add_any_connection(sys.argv[1])
    system = sdk.first_autopilot(seconds)
    if system is None:
        raise SystemExit("MAVSDK has found no autopilot")
    telemetry, param = Telemetry(system), Param(system)
    texts = []
    telemetry.subscribe_status_text(lambda text, _: texts.append(text.text))
    heard = {}
    telemetry.subscribe_attitude_euler(lambda euler, _: heard.update(attitude=[euler.roll_deg, euler.pitch_deg]))
    telemetry.subscribe_battery(lambda battery, _: heard.update(voltage=battery.voltage_v))
    waited(lambda: heard if len(heard) == 2 else None, seconds, heard)
    if sys.argv[3] == "flies":
        print(json.dumps({**fly(system, telemetry, texts, seconds), "texts": texts}))
        return sdk.destroy()

    params, others = all_params(param)
    one_by_one = sum(param.get_param_float(name) == value for name, value in params.items())
    result = {
        **heard, "armed": telemetry.armed(), "params": params, "others": others, "one_by_one": one_by_one,
        "set": tried(param.set_param_float, ParamError, "infill", 8.0),
        "infill": param.get_param_float("infill"),
        "beyond": tried(param.set_param_float, ParamError, "infill", 11.0),
        "infill_after": param.get_param_float("infill"),
        "arm": tried(Action(system).arm, ActionError),
        "grab": tried(Gripper(system).grab, GripperError, 1),
        "release": tried(Gripper(system).release, GripperError, 1),
    }
    if sys.argv[3] == "restarts":
        waited(lambda: any("stored" in text for text in texts) or None, seconds, texts)
        texts.clear()
        result["restart"] = tried(Action(system).reboot, ActionError)
        # The first text of a start.
        waited(lambda: "CALIBRATING" in texts or None, seconds, texts)
        result["after"], _ = all_params(param)
    shell, said = Shell(system), []
    shell.subscribe_receive(lambda received, _: said.append(received.data))
    answered = None
    end = time.monotonic() + seconds
    # Datagrams may be lost, and a vehicle that was silent over its restart is no system to MAVSDK for a while: asked again
    # as a person would.
    while answered is None and time.monotonic() < end:
        try:
            shell.send("get infill", Device.SHELL)
        except ShellError:
            time.sleep(0.5)
            continue
        answered = soon(lambda: "".join(said).endswith("\n> ") or None, AGAIN)
    if answered is None:
        raise SystemExit(f"MAVSDK's shell has waited in vain: heard {said}, did {result}")
    print(json.dumps({**result, "shell": "".join(said), "texts": texts}))
    sdk.destroy()


main()
