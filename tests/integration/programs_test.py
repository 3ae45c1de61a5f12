#!/usr/bin/env python3
"""Real programs over real sockets: programs_test.py BIN_DIRECTORY SOURCE_DIRECTORY [CASE]

Every wait is bounded; nothing is timed.
"""
import json
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile

BIN = pathlib.Path(sys.argv[1])
SOURCE = pathlib.Path(sys.argv[2])
LIMIT_S = 120


class Failure(Exception):
    pass


def expect(condition, why):
    if not condition:
        raise Failure(why)


def start(program, *options, **more):
    return subprocess.Popen([BIN / program, *map(str, options)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)


def finish(process):
    out, err = process.communicate(timeout=LIMIT_S)
    return process.returncode, out, err


def run(program, *options):
    return finish(start(program, *options))


class Server:
    """A server on a port of its own choice; lines of its log as they come."""

    def __init__(self, *options, **more):
        self.process = start("spoor-server", "--port=0", *options, **more)
        self.port = int(self.line_with(r" port (\d+)$").group(1))

    def line_with(self, pattern):
        while line := self.process.stderr.readline():
            if match := re.search(pattern, line.rstrip()):
                return match
        raise Failure(f"the server never said '{pattern}'")

    def join(self, name, *options):
        return start("spoor-client", f"--connect=127.0.0.1:{self.port}", "--headless", f"--name={name}", "--size=160x90", *options)


def client_hash(out):
    match = re.search(r"hash ([0-9a-f]{16})", out)
    expect(match, f"a client printed no hash: {out}")
    return match.group(1)


def clients_and_replay_end_on_the_servers_hash(scratch):
    """Two clients from the start, one killed and joined again in the middle, a replay: one hash."""
    session, figures = scratch / "convoy.session", scratch / "convoy.json"
    server = Server(f"--scene={SOURCE}/scenes/convoy.toml", "--ticks=540", "--rate=60", "--wait-clients=2",
                    f"--session={session}", f"--json={figures}")
    steady = server.join("steady", f"--out={scratch}/steady")
    leaving = server.join("leaving", f"--out={scratch}/leaving")
    server.line_with(r"tick +\d+ of 540")
    leaving.send_signal(signal.SIGKILL)
    leaving.wait()
    again = server.join("again", f"--out={scratch}/again")
    hashes = []
    for client in (steady, again):
        code, out, err = finish(client)
        expect(code == 0, f"a client failed with {code}: {err}")
        hashes.append(client_hash(out))
    code, table, err = finish(server.process)
    expect(code == 0, f"the server failed with {code}: {table} {err}")
    report = json.loads(figures.read_text())
    expect(report["ledger"]["error"] == 0, "the ledger is off")
    expect(set(hashes) == {report["server_hash"]}, f"clients {hashes}, server {report['server_hash']}")
    expect((scratch / "steady/trails.png").read_bytes() == (scratch / "again/trails.png").read_bytes(), "the pictures differ")
    for threads in (1, 3):
        code, out, err = run("spoor-replay", "verify", session, f"--threads={threads}")
        expect(code == 0 and report["server_hash"] in out, f"replay: {out} {err}")


def backends():
    """The backends that this machine can run."""
    code, devices, err = run("spoor-server", "--list-devices")
    expect(code == 0 and devices.strip(), err)
    return ("native", "gl") if "OpenGL" in devices else ("native",)


def a_session_on_either_backend_verifies_on_the_other(scratch):
    if "gl" not in backends():
        print("not run: no device for gl")
        return
    hashes = {}
    for backend in ("native", "gl"):
        server = Server(f"--scene={SOURCE}/scenes/dozer.toml", f"--backend={backend}", "--ticks=40", "--rate=0", "--wait-clients=1",
                        f"--session={scratch}/{backend}.session", f"--json={scratch}/{backend}.json")
        client = server.join("client", f"--out={scratch}/{backend}")
        code, out, err = finish(client)
        expect(code == 0, f"the client failed with {code}: {err}")
        code, table, err = finish(server.process)
        expect(code == 0, f"the server failed with {code}: {table} {err}")
        report = json.loads((scratch / f"{backend}.json").read_text())
        expect(report["backend"].startswith(backend) and report["ledger"]["error"] == 0, str(report))
        expect((report["renderer"] == "none (native)") == (backend == "native"), report["renderer"])
        hashes[backend] = report["server_hash"]
        expect(client_hash(out) == hashes[backend], "the client's hash is another")
    expect(hashes["native"] == hashes["gl"], f"{hashes}")
    for recorded, backend in (("native", "gl"), ("gl", "native"), ("gl", "auto")):
        code, out, err = run("spoor-replay", "verify", scratch / f"{recorded}.session", f"--backend={backend}")
        expect(code == 0 and hashes["gl"] in out, f"{recorded} on {backend}: {out} {err}")
        if backend == "auto":
            expect(re.search(r"^backend auto: (gl|native)", err, re.M), f"auto does not say what it took: {err}")
    code, out, err = run("spoor-replay", "verify", scratch / "gl.session", "--backend=abacus")
    expect(code == 1 and "'abacus' is none of auto, gl, native" in err, f"{code} {out} {err}")
    code, out, err = run("spoor-server", f"--scene={SOURCE}/scenes/box.toml", "--port=0", "--backend=gl", "--gl-device=77")
    expect(code == 1 and "77" in err, f"{code} {out} {err}")


# Every method and number, one after another.
CHANGES = [
    "4:numIterationsEvenOutSlopes=3,slopeThreshold=8,compression=0.5,compactionLimit=0.4",
    "9:preset=thesis-ssbo,roughness=0.6",
    "14:preset=thesis-iterative,numIterationsDisplaceMaterialToContour=5,metric=manhattan",
    "19:preset=thesis-ssbo-multiple,penetrationDivider=300,spreadCells=5,compression=0.9",
    "24:activeAreas=false,slopes=flux,jumpFloodingVariant=JFA+2",
    "29:nearest=exact,metric=chebyshev,activeAreas=true,activeAreaMargin=1.5,capacityRounds=16",
    "34:slopeThreshold=100,frustumHeight=3,obstacleThreshold=0,compression=0",
]


def a_session_whose_parameters_change_verifies_on_either_backend(scratch):
    hashes = {}
    for backend in backends():
        server = Server(f"--scene={SOURCE}/scenes/dozer.toml", f"--backend={backend}", "--ticks=40", "--rate=0", "--wait-clients=1",
                        f"--session={scratch}/{backend}.session", f"--json={scratch}/{backend}.json", *(f"--set={c}" for c in CHANGES))
        client = server.join("client", f"--out={scratch}/{backend}")
        code, out, err = finish(client)
        expect(code == 0, f"the client failed with {code}: {err}")
        code, table, err = finish(server.process)
        expect(code == 0, f"the server failed with {code}: {table} {err}")
        expect("tick 14: " in err and "displacement direct -> iterative" in err, f"changes are not said: {err}")
        report = json.loads((scratch / f"{backend}.json").read_text())
        expect(report["ledger"]["error"] == 0 and report["kept_back"] >= 0, str(report))
        hashes[backend] = report["server_hash"]
        expect(client_hash(out) == hashes[backend], "the client's hash is another")
    expect(len(set(hashes.values())) == 1, f"{hashes}")
    for recorded in hashes:
        for backend in hashes:
            code, out, err = run("spoor-replay", "verify", scratch / f"{recorded}.session", f"--backend={backend}")
            expect(code == 0 and "verified 40 ticks" in out and hashes[backend] in out, f"{recorded} on {backend}: {out} {err}")
    code, out, err = run("spoor-replay", "info", scratch / "native.session")
    expect(code == 0, err)
    expect(re.search(r"^  numIterationsEvenOutSlopes 12$", out, re.M), f"no parameters at the start: {out}")
    expect(re.findall(r"^tick (\d+): ", out, re.M) == ["4", "9", "14", "19", "24", "29", "34"], f"not every change: {out}")
    expect("tick 34: compression 0.9 -> 0, slopeThreshold 8 " in out and "frustumHeight 0 -> 3" in out, f"{out}")


def who_joins_after_a_change_holds_it(scratch):
    """Changes from the command line, then from standard input; a client from the start and one after both."""
    session, figures = scratch / "box.session", scratch / "box.json"
    server = Server(f"--scene={SOURCE}/scenes/box.toml", "--ticks=420", "--rate=60", "--wait-clients=1", "--console",
                    "--set=30:compression=0.5", f"--session={session}", f"--json={figures}", stdin=subprocess.PIPE)
    early = server.join("early", f"--out={scratch}/early")
    server.line_with(r"tick 30: compression 0 -> 0.5")
    server.process.stdin.write("rubbish\nterrainSize=3\nroughness=0.2,slopes=flux\n")
    server.process.stdin.flush()
    server.line_with(r"console: 'rubbish' is not NAME=VALUE; nothing changes")
    server.line_with(r"console: terrainSize: cannot change in a session: it shapes the world")
    tick = int(server.line_with(r"tick (\d+): roughness 1 -> 0.2, slopes exchange -> flux").group(1))
    late = server.join("late", f"--out={scratch}/late")
    hashes = []
    for client in (early, late):
        code, out, err = finish(client)
        expect(code == 0, f"a client failed with {code}: {err}")
        hashes.append(client_hash(out))
    code, table, err = finish(server.process)
    expect(code == 0, f"the server failed with {code}: {table} {err}")
    expect(set(hashes) == {json.loads(figures.read_text())["server_hash"]}, f"clients {hashes}, {table}")
    code, out, err = run("spoor-replay", "info", session)
    expect(code == 0 and "tick 30: compression 0 -> 0.5" in out and f"tick {tick}: roughness 1 -> 0.2" in out, f"{out} {err}")
    code, out, err = run("spoor-replay", "verify", session, "--backend=native")
    expect(code == 0 and hashes[0] in out, f"{out} {err}")


def craters_are_the_same_for_all(scratch):
    """Craters of the scene, of the command line, of the console and of a client; one client from the start, one that asks, one late."""
    session, figures = scratch / "craters.session", scratch / "craters.json"
    server = Server(f"--scene={SOURCE}/scenes/craters.toml", "--ticks=420", "--rate=60", "--wait-clients=2", "--console",
                    "--crater=40:7,20.5,0.3,0.6,0.2", f"--session={session}", f"--json={figures}", stdin=subprocess.PIPE)
    steady = server.join("steady", f"--out={scratch}/steady")
    asking = server.join("asking", f"--out={scratch}/asking", "--crater=60:9,21,0.4,0.8,0.25,balanced,0.3", "--crater=60:10,21.5,0.4,0.8,0.3,0.1",
                         "--crater=61:9,21,1,6,0.5", "--crater=61:9,21,2,1,0.5", "--crater=62:9,21,0.1,0.5,-1", "--crater=100000:9,21,0.4,0.8,0.25")
    server.line_with(r"tick 40: crater \d+ at \(7, 20.5\) m, R1 0.3 m")
    ids = [server.line_with(r"tick \d+: crater (\d+) at .*, asked for by client [01]$").group(1) for _ in range(2)]
    server.process.stdin.write("crater 12,22,0.5\ncrater 12,22,0.3,0.6,0.2,0.05\n")
    server.process.stdin.flush()
    server.line_with(r"console: crater: '12,22,0.5' is not X,Y,R1,R2,D5")
    server.line_with(r"tick \d+: crater \d+ at \(12, 22\) m, R1 0.3 m, R2 0.6 m, D5 0.2 m, H4 0.05 m")
    late = server.join("late", f"--out={scratch}/late")
    hashes, outputs = [], {}
    for name, client in (("steady", steady), ("asking", asking), ("late", late)):
        code, out, err = finish(client)
        expect(code == 0 and "mismatches 0" in out, f"client {name} failed with {code}: {out} {err}")
        hashes.append(client_hash(out))
        outputs[name] = out
    for request, id in zip((1, 2), ids):
        expect(re.search(rf"^request {request}: crater {id} with tick \d+$", outputs["asking"], re.M), outputs["asking"])
    for request, why in ((3, "R3 = 2 R2 - R1 is 11 m, the scene allows 8 m"), (4, "R1 2 m is more than R2 1 m"), (5, "D5 is -1 m")):
        expect(re.search(rf"^request {request}: refused: crater: {re.escape(why)}", outputs["asking"], re.M), outputs["asking"])
    expect("--crater at tick 100000: the session has ended before" in outputs["asking"], outputs["asking"])
    code, table, err = finish(server.process)
    expect(code == 0, f"the server failed with {code}: {table} {err}")
    report = json.loads(figures.read_text())
    expect(set(hashes) == {report["server_hash"]}, f"clients {hashes}, {table}")
    expect(report["ledger"]["error"] == 0 and report["ledger"]["craters"] != 0, str(report))
    expect(report["crater_count"] > 50 and report["craters_left_out"] == 0, str(report))
    asked = {client["name"]: (client["craters_asked"], client["craters_refused"]) for client in report["client_hashes"]}
    expect(asked == {"steady": (0, 0), "asking": (5, 3), "late": (0, 0)}, str(asked))
    for backend in backends():
        code, out, err = run("spoor-replay", "verify", session, f"--backend={backend}")
        expect(code == 0 and report["server_hash"] in out, f"replay on {backend}: {out} {err}")
    code, out, err = run("spoor-replay", "info", session)
    expect(code == 0 and f"craters {report['crater_count']}, ledger's crater budget {report['ledger']['craters']}" in out, f"{out} {err}")
    expect(re.search(r"^tick 40: crater \d+ at \(7, 20.5\) m", out, re.M) and "craters more" in out, out)
    code, out, err = run("spoor-replay", "export", session)
    expect(code == 0 and sum(int(line.split(",")[-2]) for line in out.splitlines()[1:]) == report["crater_count"], f"{out} {err}")


def materials_and_snow_are_the_same_for_all(scratch):
    """Several materials, a change of one of them, snow from the command line and the console; a client from the start, one late."""
    session, figures = scratch / "materials.session", scratch / "materials.json"
    server = Server(f"--scene={SOURCE}/scenes/materials.toml", "--ticks=240", "--rate=60", "--wait-clients=1", "--console",
                    "--set=10:sand.angleOfRepose=30", "--snowfall=20:0,0,9,12.8,72000,2,7", f"--session={session}",
                    f"--json={figures}", stdin=subprocess.PIPE)
    steady = server.join("steady", f"--out={scratch}/steady")
    server.line_with(r"tick 20: snowfall on \(0, 0\) to \(9, 12.8\) m, 72000 mm per hour, ticks 20 .. 139, seed 7")
    server.process.stdin.write("snow 1,2\nclay.roughness=1\nsnow 5,0,15,9,36000,1,3\nmud.diffusion=0.5\n")
    server.process.stdin.flush()
    server.line_with(r"console: snow: '1,2' is not X0,Y0,X1,Y1,MM_PER_HOUR,SECONDS")
    server.line_with(r"tick \d+: clay.roughness: no material is named 'clay'; there are: mud, sand, pebbles")
    tick = int(server.line_with(r"tick (\d+): mud.diffusion 0.25 -> 0.5").group(1))
    late = server.join("late", f"--out={scratch}/late")
    hashes = []
    for client in (steady, late):
        code, out, err = finish(client)
        expect(code == 0, f"a client failed with {code}: {err}")
        hashes.append(client_hash(out))
    code, table, err = finish(server.process)
    expect(code == 0, f"the server failed with {code}: {table} {err}")
    report = json.loads(figures.read_text())
    expect(set(hashes) == {report["server_hash"]}, f"clients {hashes}, server {report['server_hash']}")
    expect(report["ledger"]["error"] == 0 and report["ledger"]["events"] > 0, str(report))
    expect(report["snowfall_count"] == 2 and report["snowfalls_left_out"] == 0, str(report))
    code, out, err = run("spoor-replay", "verify", session, "--backend=native")
    expect(code == 0 and report["server_hash"] in out, f"{out} {err}")
    code, out, err = run("spoor-replay", "info", session)
    expect(code == 0 and "materials 3, by an image\n  mud, colour #5b4331" in out and "\n  sand.diffusion 1\n" in out, f"{out} {err}")
    expect("tick 10: sand.slopeThreshold 1 (" in out and f"tick {tick}: mud.diffusion 0.25 -> 0.5" in out, f"{out} {err}")
    expect("tick 20: snowfall on (0, 0) to (9, 12.8) m" in out and f"snowfalls 2, ledger's events {report['ledger']['events']}" in out, f"{out} {err}")
    code, out, err = run("spoor-replay", "export", session)
    expect(code == 0 and sum(int(line.split(",")[-1]) for line in out.splitlines()[1:]) == 2, f"{out} {err}")


def replay_names_the_damaged_record(scratch):
    session = scratch / "box.session"
    code, _, err = run("spoor-server", f"--scene={SOURCE}/scenes/box.toml", "--port=0", "--ticks=20", "--rate=0", f"--session={session}")
    expect(code == 0, err)
    whole = session.read_bytes()
    session.write_bytes(whole[:-40])
    code, out, err = run("spoor-replay", "verify", session)
    expect(code == 0 and "verified 19 ticks (the file ends within the next)" in out, f"{code} {out} {err}")
    session.write_bytes(whole[:-40] + bytes([whole[-40] ^ 1]) + whole[-39:])
    code, out, err = run("spoor-replay", "verify", session)
    expect(code == 1 and "damaged" in err and "byte" in err, f"{code} {out} {err}")


def a_client_says_in_one_line_why_it_cannot_join(scratch):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as closed:
        closed.bind(("127.0.0.1", 0))
        port = closed.getsockname()[1]
    for target in (f"127.0.0.1:{port}", "no-such-host.invalid:47474", "127.0.0.1:notaport"):
        code, out, err = run("spoor-client", f"--connect={target}", "--headless", f"--out={scratch}/none")
        expect(code != 0, f"{target}: joined something")
        expect(len(err.strip().splitlines()) == 1, f"{target}: not one line: {err}")


def a_client_says_that_the_server_went_away(scratch):
    server = Server(f"--scene={SOURCE}/scenes/box.toml", "--ticks=100000", "--rate=60", "--wait-clients=1")
    client = server.join("left", f"--out={scratch}/left")
    server.line_with(r"tick +\d+ of")
    server.process.send_signal(signal.SIGKILL)
    server.process.wait()
    code, _, err = finish(client)
    expect(code == 1 and len(err.strip().splitlines()) == 1, f"{code}: {err}")


def bad_command_lines_exit_2(scratch):
    for program, option in (("spoor-server", "--nonsense"), ("spoor-server", "--ticks=many"), ("spoor-client", "--nonsense"),
                            ("spoor-server", "--set=5:rubbish=1"), ("spoor-server", "--set=roughness=1"), ("spoor-server", "--set=5:terrainSize=9"),
                            ("spoor-server", "--crater=1,2,3,4,5"), ("spoor-server", "--crater=5:1,2"), ("spoor-server", "--snowfall=1,2,3,4,5,6"),
                            ("spoor-server", "--snowfall=5:1,2"), ("spoor-server", "--set=5:a.spreadCells=1"), ("spoor-client", "--crater=5:1,2"),
                            ("spoor-replay", "dance"), ("spoor-bench", "--ticks=-1"), ("spoor-import", "--scene=x")):
        code, _, err = run(program, option)
        expect(code == 2 and len(err.strip().splitlines()) == 1, f"{program} {option}: {code} {err}")
        code, out, _ = run(program, "--help")
        expect(code == 0 and "--" in out, f"{program} --help: {code}")


def bad_scenes_name_file_key_and_reason(scratch):
    scene = scratch / "bad.toml"
    scene.write_text('name = "bad"\n[world]\ncells = [64, 64]\ncell_m = -1\n[base]\nkind = "noise"\n')
    code, _, err = run("spoor-server", f"--scene={scene}")
    expect(code == 1 and "bad.toml" in err and "cell_m" in err, err)
    code, _, err = run("spoor-server", f"--scene={scratch}/missing.toml")
    expect(code == 1 and "missing.toml" in err, err)
    code, _, err = run("spoor-server", f"--scene={SOURCE}/scenes/box.toml", "--backend=abacus")
    expect(code == 1 and "abacus" in err, err)


CASES = [
    clients_and_replay_end_on_the_servers_hash,
    a_session_on_either_backend_verifies_on_the_other,
    a_session_whose_parameters_change_verifies_on_either_backend,
    who_joins_after_a_change_holds_it,
    craters_are_the_same_for_all,
    materials_and_snow_are_the_same_for_all,
    replay_names_the_damaged_record,
    a_client_says_in_one_line_why_it_cannot_join,
    a_client_says_that_the_server_went_away,
    bad_command_lines_exit_2,
    bad_scenes_name_file_key_and_reason,
]


def main():
    wanted = sys.argv[3] if len(sys.argv) > 3 else None
    chosen = [case for case in CASES if wanted in (None, case.__name__)]
    if not chosen:
        print(f"no case {wanted}; there are: {', '.join(case.__name__ for case in CASES)}")
        return 2
    failed = 0
    for case in chosen:
        with tempfile.TemporaryDirectory() as folder:
            try:
                case(pathlib.Path(folder))
                print(f"ok      {case.__name__}")
            except (Failure, subprocess.TimeoutExpired) as fault:
                failed += 1
                print(f"FAILED  {case.__name__}: {fault}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
