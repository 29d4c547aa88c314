"""pymavlink, which others wrote, reads every field of every message, all parameters, and has its commands obeyed.

usage: pymavlink_client.py PORT, with the module `sophie` that mavgen made of mavlink/definitions on the path.
"""
import json
import lzma
import math
import os
import re
import sys
import tempfile
import time

os.environ['MAVLINK20'] = '1'
from pymavlink import mavftp, mavutil  # noqa: E402
from pymavlink.dialects.v20 import common  # noqa: E402
import sophie  # noqa: E402

NAN = float('nan')
ANY = object()
NO16 = 65535
# MAVLink's packing of the version that the workspace states: major, minor, patch, type.
MANIFEST = os.path.join(os.path.dirname(__file__), '../../../Cargo.toml')
with open(MANIFEST, encoding='utf-8') as manifest:
    VERSION = re.search(r'^version = "(\d+)\.(\d+)\.(\d+)"', manifest.read(), re.M).groups()
FLIGHT_SW_VERSION = sum(int(part) << shift for part, shift in zip(VERSION, (24, 16, 8)))

# The picture of mavlink/examples/serve.rs in MAVLink's units; ANY is a time.
HALF_ROLL, HALF_PITCH, HALF_YAW = 0.25, -0.125, 1.0
CR, SR, CP, SP = math.cos(HALF_ROLL), math.sin(HALF_ROLL), math.cos(HALF_PITCH), math.sin(HALF_PITCH)
CY, SY = math.cos(HALF_YAW), math.sin(HALF_YAW)
HEALTHY = (1 | 2 | 1 << 10 | 1 << 11 | 1 << 15 | 1 << 16 | 1 << 21)
RATES = {'rollspeed': 0.125, 'pitchspeed': -0.25, 'yawspeed': 0.5}
TRUTH = {
    'HEARTBEAT': {'type': 2, 'autopilot': 0, 'base_mode': 1, 'custom_mode': 1, 'system_status': 3, 'mavlink_version': 3},
    'SYS_STATUS': {
        'onboard_control_sensors_present': HEALTHY | 1 << 25 | 1 << 28,
        'onboard_control_sensors_enabled': HEALTHY | 1 << 25 | 1 << 28,
        'onboard_control_sensors_health': HEALTHY,
        'load': 375, 'voltage_battery': 13250, 'current_battery': 250, 'battery_remaining': 75,
        'drop_rate_comm': 0, 'errors_comm': 0, 'errors_count1': 0, 'errors_count2': 0, 'errors_count3': 0,
        'errors_count4': 0, 'onboard_control_sensors_present_extended': 0,
        'onboard_control_sensors_enabled_extended': 0, 'onboard_control_sensors_health_extended': 0},
    'EXTENDED_SYS_STATE': {'vtol_state': 0, 'landed_state': 1},
    'CURRENT_MODE': {'standard_mode': 0, 'custom_mode': 1, 'intended_custom_mode': 0},
    'ATTITUDE': {'time_boot_ms': ANY, 'roll': 0.5, 'pitch': -0.25, 'yaw': 2.0, **RATES},
    'ATTITUDE_QUATERNION': {
        'time_boot_ms': ANY, 'q1': CR * CP * CY + SR * SP * SY, 'q2': SR * CP * CY - CR * SP * SY,
        'q3': CR * SP * CY + SR * CP * SY, 'q4': CR * CP * SY - SR * SP * CY, **RATES,
        'repr_offset_q': [0.0] * 4},
    'SOPHIE_ARMS': {
        'time_boot_ms': ANY, 'tilt': [-0.25, 0.125, NAN, 0.5], 'pressure': [950.0, 12.5, 0.0, 0.0],
        'force': [64.0, 8.0, 16.0, 0.0], 'reel': [0.0, 1.0, 2.0, 4.5], 'closure': [2.5, NAN, NAN, NAN],
        'state': [3, 1, 5, 0], 'flags': 1},
    'RC_CHANNELS': {
        'time_boot_ms': ANY, 'chancount': 8, 'chan1_raw': 1750, 'chan2_raw': 1750, 'chan3_raw': 1750,
        'chan4_raw': 1000, 'chan5_raw': 1000, 'chan6_raw': 2000, 'chan7_raw': 2000, 'chan8_raw': 1500,
        **{f'chan{n}_raw': NO16 for n in range(9, 19)}, 'rssi': 255},
    'SERVO_OUTPUT_RAW': {
        'time_usec': ANY, 'port': 0, 'servo1_raw': 1000, 'servo2_raw': 1125, 'servo3_raw': 1500, 'servo4_raw': 2000,
        'servo5_raw': 550, 'servo6_raw': 1000, 'servo7_raw': 1500, 'servo8_raw': 2450,
        **{f'servo{n}_raw': 0 for n in range(9, 17)}},
    'BATTERY_STATUS': {
        'id': 0, 'battery_function': 1, 'type': 1, 'temperature': 32767, 'voltages': [13250] + [NO16] * 9,
        'current_battery': 250, 'current_consumed': 450, 'energy_consumed': -1, 'battery_remaining': 75,
        'time_remaining': 0, 'charge_state': 2, 'voltages_ext': [0] * 4, 'mode': 0, 'fault_bitmask': 0},
    'SCALED_IMU': {
        'time_boot_ms': ANY, 'xacc': 500, 'yacc': -1000, 'zacc': 250, 'xgyro': 125, 'ygyro': -250, 'zgyro': 500,
        'xmag': 0, 'ymag': 0, 'zmag': 0, 'temperature': 0},
}
TEXTS = ['DISARMED', 'tipped over', 'infill below what was flown', 'arming: tilt too large', 'arming: battery low']
failures = []


def check(holds, what):
    if not holds:
        failures.append(what)


def same(got, expected, tolerance):
    if expected is ANY:
        return True
    if isinstance(expected, list):
        return len(got) == len(expected) and all(same(g, e, tolerance) for g, e in zip(got, expected))
    if isinstance(expected, float):
        return math.isnan(got) if math.isnan(expected) else abs(got - expected) < tolerance
    return got == expected


def compare(message):
    truth = TRUTH[message.get_type()]
    fields = message.to_dict()
    fields.pop('mavpackettype')
    check(set(fields) == set(truth), f'{message.get_type()}: fields {sorted(set(fields) ^ set(truth))}')
    for name, expected in truth.items():
        got = getattr(message, name, None)
        # Angles come through the vehicle's own arctangent, which errs by 0.0029 rad at most.
        tolerance = 3e-3 if name in ('roll', 'pitch', 'yaw') else 1e-5
        check(same(got, expected, tolerance), f'{message.get_type()}.{name}: {got}, expected {expected}')


def command(link, number, *params):
    params = list(params) + [0] * (7 - len(params))
    link.mav.command_long_send(1, 1, number, 0, *params)
    ack = link.recv_match(type='COMMAND_ACK', blocking=True, timeout=3)
    return None if ack is None or ack.command != number else ack.result


def crc32(content):
    """MAVLink's checksum of a file: from 0, not inverted at the end."""
    crc = 0
    for byte in content:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xEDB88320 if crc & 1 else 0)
    return crc


def fetched(link, uri):
    """The file by the client's own transfer."""
    ftp = mavftp.MAVFTP(link, 1, 1)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'file')
        ftp.cmd_get([uri.removeprefix('mftp://'), path])
        answer = ftp.process_ftp_reply('OpenFileRO', timeout=30)
        if answer.error_code != 0 or not os.path.exists(path):
            raise SystemExit(f'{uri}: not fetched, error {answer.error_code}')
        with open(path, 'rb') as file:
            return file.read()


def compare_metadata(link, names):
    check(command(link, 512, 397) == 0, 'request of COMPONENT_METADATA')
    about = link.recv_match(type='COMPONENT_METADATA', blocking=True, timeout=3)
    general = fetched(link, about.uri)
    check(crc32(general) == about.file_crc, f'{about.uri}: checksum')
    kinds = {kind['type']: kind for kind in json.loads(general)['metadataTypes']}
    check(list(kinds) == [1], f'{kinds}')
    content = lzma.decompress(fetched(link, kinds[1]['uri']))
    check(crc32(content) == kinds[1]['fileCrc'], f'{kinds[1]["uri"]}: checksum')
    described = {row['name']: row for row in json.loads(content)['parameters']}
    check(set(described) == names, f'described, but none or the reverse: {set(described) ^ names}')
    infill = described['infill']
    check((infill['min'], infill['max'], infill['units']) == (4, 10, '%'), f'{infill}')
    check(len(described['motor_protocol']['values']) == 5, 'choices of motor_protocol')


def main():
    link = mavutil.mavlink_connection(f'tcp:127.0.0.1:{sys.argv[1]}', source_system=255, source_component=190)
    # The part of the standard that the vehicle was built with is the standard.
    shared = [number for number in sophie.mavlink_map if number in common.mavlink_map]
    check(len(shared) > 20, f'{len(shared)} messages of the standard')
    for own, standard in ((sophie.mavlink_map[n], common.mavlink_map[n]) for n in shared):
        check((own.msgname, own.crc_extra) == (standard.msgname, standard.crc_extra), f'{own.msgname} differs')
        # One of the two may be older and lack extension fields, which come last.
        for what in ('fieldnames', 'fieldtypes'):
            pairs = zip(getattr(own, what), getattr(standard, what))
            check(all(a == b for a, b in pairs), f'{own.msgname}: {what} differ')
    link.mav = sophie.MAVLink(link, srcSystem=255, srcComponent=190)
    link.mav.robust_parsing = True
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    seen, texts, end = {}, [], time.time() + 4
    while time.time() < end:
        message = link.recv_match(blocking=True, timeout=1)
        if message is None:
            continue
        kind = message.get_type()
        check(kind != 'BAD_DATA', f'bad data: {message}')
        if kind == 'STATUSTEXT':
            texts.append(message.text)
        elif kind in TRUTH:
            seen[kind] = seen.get(kind, 0) + 1
            compare(message)
    check(set(seen) == set(TRUTH), f'missing: {set(TRUTH) - set(seen)}')
    check(3 <= seen.get('HEARTBEAT', 0) <= 6, f'heartbeats: {seen}')
    check(texts == TEXTS, f'texts: {texts}')

    link.mav.param_request_list_send(1, 1)
    values, end = {}, time.time() + 15
    while time.time() < end:
        value = link.recv_match(type='PARAM_VALUE', blocking=True, timeout=1)
        if value is None:
            continue
        values[value.param_index] = value
        if len(values) == value.param_count:
            break
    check(values and len(values) == values[0].param_count, f'{len(values)} parameters')
    names = {value.param_id: value.param_value for value in values.values()}
    check(abs(names.get('infill', 0) - 6.9) < 1e-5 and names.get('motor_protocol') == 300, 'values')
    compare_metadata(link, set(names))
    for wanted, echoed in ((8.0, 8.0), (11.0, 8.0)):
        link.mav.param_set_send(1, 1, b'infill', wanted, 9)
        value = link.recv_match(type='PARAM_VALUE', blocking=True, timeout=3)
        check(value and value.param_id == 'infill' and value.param_value == echoed, f'infill {wanted}: {value}')
    stored = link.recv_match(type='STATUSTEXT', blocking=True, timeout=3)
    check(stored and stored.text == 'infill: not an allowed value', f'{stored}')
    stored = link.recv_match(type='STATUSTEXT', blocking=True, timeout=3)
    check(stored and stored.text == 'parameters stored: in force after a restart', f'{stored}')

    check(command(link, 16) == 3, 'an unknown command is unsupported')
    check(command(link, 512, 148) == 0, 'request of AUTOPILOT_VERSION')
    version = link.recv_match(type='AUTOPILOT_VERSION', blocking=True, timeout=3)
    check(version and version.flight_sw_version == FLIGHT_SW_VERSION, f'{version}')
    check(command(link, 512, 435) == 0, 'request of AVAILABLE_MODES')
    modes = []
    while len(modes) < 11 and (mode := link.recv_match(type='AVAILABLE_MODES', blocking=True, timeout=3)):
        modes.append(mode.mode_name)
    check(modes[:4] == ['CALIBRATING', 'DISARMED', 'ARMED', 'FLIGHT'] and len(modes) == 11, f'{modes}')
    check(command(link, 511, 30, 50000) == 0, 'an interval')
    link.mav.timesync_send(0, 12345)
    sync = link.recv_match(type='TIMESYNC', blocking=True, timeout=3)
    check(sync and sync.ts1 == 12345 and sync.tc1 > 0, f'{sync}')
    check(command(link, 246, 1) == 0, 'a restart')

    for failure in sorted(set(failures)):
        print(failure, file=sys.stderr)
    print(f'pymavlink: {sum(seen.values())} messages of {len(seen)} kinds, {len(values)} parameters')
    return 1 if failures else 0


sys.exit(main())
