#!/usr/bin/env python3
# A driven axis whose machine is made here, logged by loggers of every habit: each gives the same verdict, or one true sentence.
import json, math, os, random, shutil, sys, tempfile

from program import expect, expect_refusal, run

SEED = int(os.environ.get("PNEUSERVO_TEST_SEED", random.randrange(1 << 30)))
print(f"seed {SEED} (PNEUSERVO_TEST_SEED)")
draw = random.Random(SEED)
folder = tempfile.mkdtemp()
MASS_kg, VISCOUS_Ns_per_m, COULOMB_N, NOISE_N = 20.0, 150.0, draw.uniform(15, 30), 0.1
CONFIG = f"""format: pneuservo-rig/1
name: axis
rig: driven_axis
period_s: 0.001
slider: {{mass_kg: {MASS_kg}, viscous_friction_Ns_per_m: {VISCOUS_Ns_per_m}, stroke_m: 0.6, force_max_N: 400.0}}
sensors:
  position: {{quantum_m: 1.0e-7, noise_m: 1.0e-7}}
  force: {{quantum_N: 0.0, noise_N: {NOISE_N}}}
controller: {{kind: pd_force, position_gain_N_per_m: 100000.0, velocity_gain_Ns_per_m: 2000.0, velocity_filter_s: 0.001}}
reference: {{kind: sine, amplitude_m: 0.12, frequency_Hz: 0.8}}
tolerances: {{slider.mass_kg: 0.001, slider.viscous_friction_Ns_per_m: 0.01}}
"""


def rows(interval_s, seconds=8.0, jitter_s=0.0, held_s=0.001):
    """t, x, F of an ideal axis on a sum of sines; the force is held for so long from each row on, 0: of its instant."""
    out = []
    for i in range(int(seconds / interval_s)):
        t = i * interval_s + (draw.gauss(0, jitter_s) if i and jitter_s else 0)

        def motion(at):
            parts = [(0.11, 4.1, 0.3), (0.03, 9.7, 1.1)]
            return (sum(a * math.sin(w * at + p) for a, w, p in parts), sum(a * w * math.cos(w * at + p) for a, w, p in parts),
                    -sum(a * w * w * math.sin(w * at + p) for a, w, p in parts))
        x = motion(t)[0]
        _, v, a = motion(t + 0.5 * held_s)
        out.append((t, x, MASS_kg * a + VISCOUS_Ns_per_m * v + math.copysign(COULOMB_N, v) + draw.gauss(0, NOISE_N)))
    return out


def write(name, table, names=("t_s", "x_m", "F_N"), separator=",", form="{:.9g}", head=""):
    path = os.path.join(folder, name)
    with open(path, "w") as file:
        file.write(head + separator.join(names) + "\n")
        for row in table:
            file.write(separator.join("" if value is None else form.format(value) for value in row) + "\n")
    return path


def put(name, text):
    path = os.path.join(folder, name)
    with open(path, "w") as file:
        file.write(text)
    return path


config = put("axis.yaml", CONFIG)
# Rows 10 ms apart show dry friction's step where the motion turns over 50 ms: Stribeck's is not told from it.
COARSE = ("coulomb_friction", "stribeck_friction")


def diagnosis(path, *more, rig=config):
    done = run("diagnose", rig, path, "--quiet", "--json", "-", *more)
    expect(done.returncode == 0, f"{path}: status {done.returncode}: {done.stderr}")
    return json.loads(done.stdout)


def friction_of(found, name):
    """Names of the verdict, and the size of its constant friction."""
    names = [answer["effect"] for answer in found["answers"]]
    sizes = found["answers"][0]["parameters"] if names else {}
    size = sizes.get("force_N") or sizes.get("coulomb_force_N")
    expect(size is not None, f"{name}: {names} instead of dry friction: {found['data']['warnings']}")
    return names, size["value"]


def expect_coulomb(name, path, *more, rig=config, told=(), kinds=("coulomb_friction",)):
    """The verdict on the whole recording, with its size."""
    found = diagnosis(path, *more, rig=rig)
    names, force_N = friction_of(found, name)
    expect(len(names) == 1, f"{name}: {names} instead of one name: {found['data']['warnings']}")
    expect(names[0] in kinds, f"{name}: {names}: {found['data']['warnings']}")
    expect(abs(force_N - COULOMB_N) < 0.02 * COULOMB_N, f"{name}: {force_N} N instead of {COULOMB_N}")
    for word in told:
        expect(any(word in line for line in found["data"]["warnings"]), f"{name}: '{word}' is not told: {found['data']['warnings']}")


whole = rows(0.001)
expect_coulomb("whole", write("whole.csv", whole))
for every in (2, 4, 10):
    thinned = whole[::every]
    expect_coulomb(f"every {every}. row", write(f"every{every}.csv", thinned), told=[f"{0.001 * every:g} s apart"],
                   kinds=COARSE if every == 10 else ("coulomb_friction",))
expect_coulomb("5 kHz", write("fast.csv", rows(0.0005)))
expect_coulomb("jitter", write("jitter.csv", rows(0.002, jitter_s=0.0002)))
expect_coulomb("3 % lost", write("lost.csv", [row for row in whole if draw.random() > 0.03]))
start = draw.randrange(3000, 5000)
expect_coulomb("gap", write("gap.csv", whole[:start] + whole[start + 300:]), told=["recording of its own"])
jumped = whole[:start] + [(t + 3600, x, f) for t, x, f in whole[start:]]
expect_coulomb("clock jump", write("jump.csv", jumped), told=["recording of its own"])
expect_coulomb("two runs", write("two.csv", whole[:4000] + [(t - 4.0, x, f) for t, x, f in whole[4000:]]),
               told=["recording of their own"])
expect_coulomb("sparse", write("sparse.csv", [(t, x if i % 2 == 0 else None, f) for i, (t, x, f) in enumerate(whole)]))
expect_coulomb("instant", write("instant.csv", rows(0.001, held_s=0)), told=["sampling"])

# Rows 10 ms apart whose force is held from row to row, or of their instants: right where that is stated, otherwise not.
for sampling, held_s, other in (("held", 0.01, "instant"), ("instant", 0, "held")):
    path = write(f"{sampling}.csv", rows(0.01, seconds=20, held_s=held_s))
    stated = [put(f"{word}.yaml", CONFIG + f"import: {{columns: {{F_N: {{column: F_N, sampling: {word}}}}}}}\n") for word in (sampling, other)]
    expect_coulomb(f"force {sampling}", path, rig=stated[0], kinds=COARSE)
    wrong = diagnosis(path, rig=stated[1])
    expect([answer["effect"] for answer in wrong["answers"]] not in (["coulomb_friction"], ["stribeck_friction"]),
           f"force {sampling}, stated as {other}: {wrong['verdict']}, as if it made no difference")

# A counter of 0.1 m, a sensor whose range ends at 9 cm, a night between the rows.
turned = [(t, (x + 0.05) % 0.1 - 0.05, f) for t, x, f in whole]
expect_coulomb("turns", write("turns.csv", turned), told=["begins again"])
clipped = [(t, min(x, 0.09), f) for t, x, f in whole]
expect_coulomb("clipped", write("clipped.csv", clipped), told=["x_m is clipped at 0.09"])
night = "".join(f"{(86396 + t) % 86400 // 3600:02.0f}:{(86396 + t) % 3600 // 60:02.0f}:{(86396 + t) % 60:06.3f},{x:.9g},{f:.6g}\n" for t, x, f in whole)
expect_coulomb("night", put("night.csv", "t_s,x_m,F_N\n" + night), told=["midnight"])

for unit, factor, shift in (("ms", 1e3, 0), ("us", 1e6, 0), ("ns", 1e9, 0), ("epoch us", 1e6, 1.77e9), ("epoch ns", 1e9, 1.77e9)):
    table = [(round((t + shift) * factor), x, f) for t, x, f in whole]
    path = put("unit.csv", "t_s,x_m,F_N\n" + "".join(f"{t},{x:.9g},{f:.6g}\n" for t, x, f in table))
    expect_coulomb(unit, path, told=["taken in seconds"])
expect_coulomb("mm", write("mm.csv", [(t, 1000 * x, f) for t, x, f in whole]), told=["millimetres", "factor: 0.001"])
comma = put("comma.csv", ("t_s;x_m;F_N\n" + "".join(f"{t:.6f};{x:.9f};{f:.4f}\n" for t, x, f in whole)).replace(".", ","))
expect_coulomb("semicolons", comma, told=["separator ;", "decimal comma"])
mapped = put("mapped.yaml", CONFIG + 'import: {columns: {t_s: {column: "Zeit [s]"}, x_m: {column: "Weg [mm]", factor: 0.001}, '
             'F_N: {column: "Kraft [N]"}}}\n')
foreign = write("foreign.csv", [(t, 1000 * x, f) for t, x, f in whole], names=("Zeit [s]", "Weg [mm]", "Kraft [N]"))
expect_coulomb("mapped", foreign, rig=mapped)
frozen = [(t, whole[2000][1] if 2000 <= i < 2800 else x, f) for i, (t, x, f) in enumerate(whole)]
expect_coulomb("frozen", write("frozen.csv", frozen), told=["is frozen"])

for name, table, words in (("dead encoder", [(t, 0.1, f) for t, _, f in whole], ["does not move"]),
                           ("two seconds of gaps", [row for i, row in enumerate(whole) if i % 300 < 200], ["no stretch"]),
                           ("beyond the stroke", [(t, x + 3, f) for t, x, f in whole], ["x_m goes from", "stroke"])):
    expect_refusal(run("diagnose", config, write("refused.csv", table)), words, name)
expect_refusal(run("diagnose", config, foreign), ["t_s is missing", "Weg [mm]", "pneuservo import"], "no map")

# The verb import understands the foreign names and writes the section that diagnose reads.
written = os.path.join(folder, "written.yaml")
done = run("import", foreign, config, "--write", written, "--report", os.path.join(folder, "page.html"), "--json", "-")
expect(done.returncode == 0, f"import: {done.stderr}")
again = ["import", foreign, config, "--write", written]
expect_refusal(run(*again), ["--write", written, "an older result of import", "--force"], "import over its own result")
expect(run(*again, "--force").returncode == 0, "import --force over its own result")
shutil.copy(config, os.path.join(folder, "person.yaml"))
expect_refusal(run("import", foreign, config, "--force", "--write", os.path.join(folder, "person.yaml")), ["something else"],
               "import --force over a person's config")
understood = {column["column"]: (column["taken_for"], column["factor"]) for column in json.loads(done.stdout)["columns"]}
expect(understood == {"Zeit [s]": ("t_s", 1), "Weg [mm]": ("x_m", 0.001), "Kraft [N]": ("F_N", 1)}, f"import: {understood}")
expect_coulomb("written section", foreign, rig=written)
expect("Weg [mm]" in open(os.path.join(folder, "page.html")).read(), "import: the page does not show the columns")
