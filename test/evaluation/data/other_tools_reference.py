#!/usr/bin/env python3
"""Values of evo, rpg_trajectory_evaluation and ov_eval for the example trajectories beside this file.

Written from those programs' sources alone (named at each function), with numpy and 4x4 matrices, by
exhaustive search; it shares nothing with evaluation/definitions, whose test compares against what is
kept in other_tools_expected.json. Neither the tests nor CI run it:

    python3 other_tools_reference.py            compare with the files kept
    python3 other_tools_reference.py --write    write trajectories and values anew

Needs numpy (Debian: python3-numpy).
"""

import json
import math
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
LENGTHS_M = [2.0, 5.0, 10.0]


# ------------------------------------------------------------------ example trajectories


def rot(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = np.eye(3)
    R[i, i], R[j, j], R[i, j], R[j, i] = c, c, -s, s
    return R


def true_pose(t):
    T = np.eye(4)
    T[:3, :3] = rot(2, 0.4 * t) @ rot(1, 0.2 * math.sin(t)) @ rot(0, 0.3 * math.cos(0.8 * t))
    T[:3, 3] = [6 * math.sin(0.6 * t), 4 * math.sin(0.9 * t + 0.5), 0.8 * math.sin(1.3 * t)]
    return T


def estimated_pose(t):
    """The truth with a drift, seen from another global frame and with metres 1 % too short."""
    T = true_pose(t)
    T[:3, 3] += [0.03 * math.sin(1.7 * t), 0.02 * t + 0.02 * math.cos(2.3 * t), 0.015 * t]
    tip = rot(0, math.radians(0.5 * math.sin(0.9 * t))) @ rot(1, math.radians(0.4 * math.cos(1.1 * t)))
    T[:3, :3] = rot(2, math.radians(0.25 * t)) @ tip @ T[:3, :3]
    S = rot(2, math.radians(40.0)) @ rot(0, math.radians(1.0))
    T[:3, 3] = 1.01 * (S @ T[:3, 3]) + [3.0, -2.0, 1.0]
    T[:3, :3] = S @ T[:3, :3]
    return T


def quaternion(R):
    """Of a rotation matrix, x y z w with w >= 0, by the eigenvector of its 4x4 form."""
    K = np.empty((4, 4))
    K[:3, :3] = R + R.T - np.trace(R) * np.eye(3)
    K[3, :3] = K[:3, 3] = [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]
    K[3, 3] = np.trace(R)
    q = np.linalg.eigh(K)[1][:, -1]
    return q if q[3] >= 0 else -q


def tum_text(stamps_ns, start_ns, pose):
    lines = []
    for ns in stamps_ns:
        T = pose(ns * 1e-9)
        q = quaternion(T[:3, :3])
        at = start_ns + ns
        lines.append(
            "%d.%09d %s" % (at // 10**9, at % 10**9, " ".join("%.9f" % v for v in [*T[:3, 3], *q]))
        )
    return "\n".join(lines) + "\n"


def examples():
    """name -> (truth, estimate) as TUM text."""
    ms = 10**6
    # gap: today's stamps; the truth at 25 Hz lacks a second (4 m of way), the estimate at 20 Hz
    # jitters, lacks 0.7 s elsewhere and has poses 6 ms apart, which share a partner in evo.
    truth = [k * 40 * ms for k in range(300) if not 125 <= k < 150]
    estimate = []
    for k in range(236):
        if 170 <= k < 184:
            continue
        at = k * 50 * ms + ((k * 7) % 9 - 4) * ms + 3 * ms
        estimate.append(at)
        if k % 40 == 4:
            estimate.append(at + 6 * ms)
    epoch = 1403636583763555584
    gap = (tum_text(truth, epoch, true_pose), tum_text(estimate, epoch, estimated_pose))
    # fast: small stamps; the estimate at 50 Hz is denser than the truth at 20 Hz, so that evo walks
    # the truth and ov_eval gives a true pose to the first of the estimate's that comes near.
    truth = [k * 50 * ms for k in range(121)]
    estimate = [k * 20 * ms + 7 * ms for k in range(295)]
    fast = (tum_text(truth, 10**9, true_pose), tum_text(estimate, 10**9, estimated_pose))
    return {"gap": gap, "fast": fast}


# ------------------------------------------------------------------ what all three share


class Trajectory:
    def __init__(self, text):
        rows = [[float(v) for v in line.split()] for line in text.splitlines()]
        self.t = [row[0] for row in rows]
        self.T = [pose_matrix(row[1:4], row[4:8]) for row in rows]


def pose_matrix(p, q):
    x, y, z, w = np.asarray(q) / np.linalg.norm(q)
    T = np.eye(4)
    T[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    T[:3, 3] = p
    return T


def inverse(T):
    return np.linalg.inv(T)


def angle_deg(R):
    """Of a rotation matrix, from both its sine and its cosine."""
    sine = 0.5 * np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return math.degrees(math.atan2(sine, 0.5 * (np.trace(R) - 1.0)))


def positions(poses):
    return np.array([T[:3, 3] for T in poses])


def way(points):
    distance = [0.0]
    for a, b in zip(points, points[1:]):
        distance.append(distance[-1] + np.linalg.norm(b - a))
    return distance


def umeyama(est, ref, with_scale):
    """s, R, t of ref = s R est + t (Umeyama 1991)."""
    mean_est, mean_ref = est.mean(axis=0), ref.mean(axis=0)
    d_est, d_ref = est - mean_est, ref - mean_ref
    covariance = d_ref.T @ d_est / len(est)
    U, D, Vt = np.linalg.svd(covariance)
    S = np.diag([1.0, 1.0, -1.0 if np.linalg.det(U) * np.linalg.det(Vt) < 0 else 1.0])
    R = U @ S @ Vt
    s = np.trace(np.diag(D) @ S) / np.mean(np.sum(d_est**2, axis=1)) if with_scale else 1.0
    return s, R, mean_ref - s * R @ mean_est


def best_yaw(C):
    """The angle about z that maximizes trace(Rz C)."""
    return math.atan2(C[0, 1] - C[1, 0], C[0, 0] + C[1, 1])


def yaw_fit(est, ref):
    d_est, d_ref = est - est.mean(axis=0), ref - ref.mean(axis=0)
    R = rot(2, best_yaw(d_est.T @ d_ref))
    return 1.0, R, ref.mean(axis=0) - R @ est.mean(axis=0)


def first_pose_yaw(est, ref):
    R = rot(2, best_yaw(est[0][:3, :3] @ ref[0][:3, :3].T))
    return 1.0, R, ref[0][:3, 3] - R @ est[0][:3, 3]


def first_pose(est, ref):
    T = ref[0] @ inverse(est[0])
    return 1.0, T[:3, :3], T[:3, 3]


def moved(poses, similarity):
    s, R, t = similarity
    result = []
    for T in poses:
        M = np.eye(4)
        M[:3, :3] = R @ T[:3, :3]
        M[:3, 3] = s * R @ T[:3, 3] + t
        result.append(M)
    return result


def statistics(values, ddof=0):
    values = np.asarray(values, dtype=float)
    if len(values) == 0:
        return dict(count=0, rmse=None, mean=None, median=None, std=None, min=None, max=None)
    return dict(
        count=len(values),
        rmse=math.sqrt(np.mean(values**2)),
        mean=float(np.mean(values)),
        median=float(np.median(values)),
        std=None if len(values) <= ddof else float(np.std(values, ddof=ddof)),
        min=float(np.min(values)),
        max=float(np.max(values)),
    )


def similarity_json(similarity):
    s, R, t = similarity
    return dict(p_GE_m=[float(v) for v in t], q_GE_xyzw=[float(v) for v in quaternion(R)], scale=float(s))


# ------------------------------------------------------------------ evo


def evo_match(est, ref, max_diff=0.01):
    """evo/core/sync.py: associate_trajectories, matching_time_indices (0e935978893c)."""
    walk_ref = len(est.t) > len(ref.t)
    short, long = (ref, est) if walk_ref else (est, ref)
    matches = []
    for i, t in enumerate(short.t):
        diffs = [abs(u - t) for u in long.t]
        k = int(np.argmin(diffs))
        if diffs[k] <= max_diff:
            matches.append((k, i) if walk_ref else (i, k))
    return matches  # (estimate, truth)


def evo_align(est, ref, alignment, n):
    """evo/main_ape.py: ape (02608915cb92); evo/core/geometry.py (1962b69eda04)."""
    use = slice(None) if n == -1 else slice(0, n)
    if alignment == "none":
        return 1.0, np.eye(3), np.zeros(3)
    if alignment == "origin":
        return first_pose(est, ref)
    s, R, t = umeyama(positions(est)[use], positions(ref)[use], alignment != "se3")
    return (s, np.eye(3), np.zeros(3)) if alignment == "scale" else (s, R, t)


def evo_pairs(poses, delta, unit, all_pairs):
    """evo/core/filters.py: filter_pairs_by_index, filter_pairs_by_path (ec06cd615ff2)."""
    n = len(poses)
    if unit == "frames":
        if all_pairs:
            return [(i, i + delta) for i in range(n - delta)]
        kept = list(range(0, n, delta))
        return list(zip(kept, kept[1:]))
    points = positions(poses)
    if all_pairs:
        distance = way(points)
        found = []
        for i in range(n - 1):
            off = [abs(distance[j] - distance[i] - delta) for j in range(i + 1, n)]
            k = int(np.argmin(off))
            if off[k] <= 0.1 * delta:
                found.append((i, i + 1 + k))
        return found
    kept, gone = [], 0.0
    for i in range(1, n):
        gone += np.linalg.norm(points[i] - points[i - 1])
        if gone >= delta:
            kept.append(i)
            gone = 0.0
    return list(zip(kept, kept[1:]))


def evo(est, ref, alignment, n=-1):
    matches = evo_match(est, ref)
    E = [est.T[i] for i, _ in matches]
    G = [ref.T[k] for _, k in matches]
    similarity = evo_align(E, G, alignment, n)
    A = moved(E, similarity)

    def relations(errors):
        return dict(
            rotation_part=statistics([np.linalg.norm(M[:3, :3] - np.eye(3)) for M in errors]),
            full_transformation=statistics([np.linalg.norm(M - np.eye(4)) for M in errors]),
        )

    absolute = [inverse(a) @ g for a, g in zip(A, G)]
    result = dict(
        matches=matches,
        matched_poses=len(matches),
        alignment=similarity_json(similarity),
        position_m=statistics([np.linalg.norm(a[:3, 3] - g[:3, 3]) for a, g in zip(A, G)]),
        orientation_deg=statistics([angle_deg(M[:3, :3]) for M in absolute]),
        further=relations(absolute),
        relative=[],
    )
    kinds = [(1, "frames", False, True)]
    for length in LENGTHS_M:
        kinds += [(length, "m", True, False), (length, "m", False, False)]
    for delta, unit, all_pairs, own in kinds:
        errors = []
        for i, j in evo_pairs(A, delta, unit, all_pairs):
            errors.append(inverse(inverse(G[i]) @ G[j]) @ (inverse(A[i]) @ A[j]))
        result["relative"].append(
            dict(
                delta=delta,
                unit=unit,
                pairs="all" if all_pairs else "consecutive",
                own_default=own,
                segments=len(errors),
                translation_m=statistics([np.linalg.norm(M[:3, 3]) for M in errors]),
                rotation_deg=statistics([angle_deg(M[:3, :3]) for M in errors]),
                further=relations(errors),
            )
        )
    return result


# ------------------------------------------------------------------ rpg_trajectory_evaluation


def rpg_match(est, ref, max_diff=0.02):
    """associate_timestamps.py: associate (749ce6e7161c), called (estimate, groundtruth) with 0.02."""
    candidates = []
    for i, a in enumerate(est.t):
        for k, b in enumerate(ref.t):
            if abs(a - b) < max_diff:
                candidates.append((abs(a - b), i, k))
    used_est, used_ref, matches = set(), set(), []
    for _, i, k in sorted(candidates):
        if i not in used_est and k not in used_ref:
            used_est.add(i)
            used_ref.add(k)
            matches.append((i, k))
    return sorted(matches)


def rpg_align(est, ref, alignment, n):
    """align_utils.py (f0d1773cb79f), align_trajectory.py (295ea5eb4c32)."""
    use = slice(None) if n == -1 else slice(0, n)
    if alignment == "none":
        return 1.0, np.eye(3), np.zeros(3)
    if alignment == "sim3":
        return umeyama(positions(est)[use], positions(ref)[use], True)
    if n == 1:
        return first_pose(est, ref) if alignment == "se3" else first_pose_yaw(est, ref)
    if alignment == "se3":
        return umeyama(positions(est)[use], positions(ref)[use], False)
    return yaw_fit(positions(est)[use], positions(ref)[use])


def rpg_segments(distance, length, reach):
    """trajectory_utils.py: compute_comparison_indices_length; compute_trajectory_errors.py takes the
    place in the list of ends for the start, although starts without an end are not in it."""
    ends = []
    for i, d in enumerate(distance):
        best, error = None, reach
        for j in range(i, len(distance)):
            if abs(distance[j] - (d + length)) < error:
                best, error = j, abs(distance[j] - (d + length))
        if best is not None:
            ends.append(best)
    return [] if len(ends) < 2 else list(enumerate(ends))


def yaw_pitch_roll(R):
    flat = math.hypot(R[0, 0], R[1, 0])
    return math.atan2(R[1, 0], R[0, 0]), math.atan2(-R[2, 0], flat), math.atan2(R[2, 1], R[2, 2])


def rpg(est, ref, alignment, n=-1):
    matches = rpg_match(est, ref)
    E = [est.T[i] for i, _ in matches]
    G = [ref.T[k] for _, k in matches]
    similarity = rpg_align(E, G, alignment, n)
    A = moved(E, similarity)
    scale_off = [
        100 * abs(np.linalg.norm(a[:3, 3]) / np.linalg.norm(g[:3, 3]) - 1) for a, g in zip(A, G)
    ]
    result = dict(
        matches=matches,
        matched_poses=len(matches),
        alignment=similarity_json(similarity),
        position_m=statistics([np.linalg.norm(a[:3, 3] - g[:3, 3]) for a, g in zip(A, G)]),
        orientation_deg=statistics([angle_deg(a[:3, :3] @ g[:3, :3].T) for a, g in zip(A, G)]),
        further=dict(scale_percent=statistics(scale_off)),
        relative=[],
    )
    total = way(positions(ref.T))[-1]  # of the whole truth, matched or not
    own = [math.trunc(share * total * 100.0) / 100.0 for share in (0.1, 0.2, 0.3, 0.4, 0.5)]
    distance = way(positions(G))
    for length, is_own in [(v, True) for v in own] + [(v, False) for v in LENGTHS_M]:
        lists = dict(m=[], percent=[], deg=[], deg_per_m=[], yaw=[], gravity=[])
        for i, j in rpg_segments(distance, length, 0.2 * length):
            moved_est = inverse(E[i]) @ E[j]
            moved_est[:3, 3] *= similarity[0]
            error = inverse(inverse(G[i]) @ G[j]) @ moved_est
            turn = np.eye(4)
            turn[:3, :3] = E[j][:3, :3]
            error = turn @ error @ turn.T
            lists["m"].append(np.linalg.norm(error[:3, 3]))
            lists["percent"].append(100 * lists["m"][-1] / length)
            lists["deg"].append(angle_deg(error[:3, :3]))
            lists["deg_per_m"].append(lists["deg"][-1] / length)
            yaw, pitch, roll = yaw_pitch_roll(error[:3, :3])
            lists["yaw"].append(abs(math.degrees(yaw)))
            lists["gravity"].append(math.degrees(math.hypot(pitch, roll)))
        result["relative"].append(
            dict(
                delta=length,
                unit="m",
                pairs="all",
                own_default=is_own,
                segments=len(lists["m"]),
                translation_m=statistics(lists["m"]),
                rotation_deg=statistics(lists["deg"]),
                further=dict(
                    translation_percent=statistics(lists["percent"]),
                    rotation_deg_per_m=statistics(lists["deg_per_m"]),
                    yaw_deg=statistics(lists["yaw"]),
                    gravity_deg=statistics(lists["gravity"]),
                ),
            )
        )
    return result


# ------------------------------------------------------------------ ov_eval


def ov_match(est, ref, max_diff=0.02):
    """ov_eval/src/alignment/AlignUtils.cpp: perform_association (5d9fbeeb52f7)."""
    matches, start, n = [], 0, len(ref.t)
    for i, t in enumerate(est.t):
        start = next((k for k in range(start, n) if ref.t[k] >= t or t - ref.t[k] <= max_diff), n)
        falling = [max_diff]  # differences that fall strictly; the last of them is the match
        for k in range(start, n):
            if abs(ref.t[k] - t) >= falling[-1]:
                break
            falling.append(abs(ref.t[k] - t))
        if len(falling) > 1:
            start += len(falling) - 1
            matches.append((i, start - 1))
    return matches


def ov_align(est, ref, alignment):
    """ov_eval/src/alignment/AlignTrajectory.cpp (e274c656324f)."""
    if alignment == "posyaw":
        return yaw_fit(positions(est), positions(ref))
    if alignment == "posyawsingle":
        return first_pose_yaw(est, ref)
    if alignment == "se3single":
        return first_pose(est, ref)
    if alignment == "none":
        return 1.0, np.eye(3), np.zeros(3)
    return umeyama(positions(est), positions(ref), alignment == "sim3")


def ov_statistics(values):
    """ov_eval/src/utils/Statistics.h (74a63cf758f5)."""
    result = statistics(values, ddof=1)
    known = result["std"] is not None
    result["p99_if_normal"] = result["mean"] + 2.326 * result["std"] if known else None
    return result


def ov_eval(est, ref, alignment):
    """ov_eval/src/calc/ResultTrajectory.{h,cpp} (d371eb189a3c), error_singlerun.cpp."""
    matches = ov_match(est, ref)
    E = [est.T[i] for i, _ in matches]
    G = [ref.T[k] for _, k in matches]
    similarity = ov_align(E, G, alignment)
    A = moved(E, similarity)
    result = dict(
        matches=matches,
        matched_poses=len(matches),
        alignment=similarity_json(similarity),
        position_m=ov_statistics([np.linalg.norm(a[:3, 3] - g[:3, 3]) for a, g in zip(A, G)]),
        orientation_deg=ov_statistics([angle_deg(a[:3, :3] @ g[:3, :3].T) for a, g in zip(A, G)]),
        further={},
        relative=[],
    )
    distance = way(positions(G))
    own = [8.0, 16.0, 24.0, 32.0, 40.0]
    for length, is_own in [(v, True) for v in own] + [(v, False) for v in LENGTHS_M]:
        metres, degrees = [], []
        for i in range(len(G)):
            best, error = None, 0.5
            for j in range(i, len(G)):
                if abs(distance[j] - (distance[i] + length)) < error:
                    best, error = j, abs(distance[j] - (distance[i] + length))
            if best is None:
                continue
            off = inverse(inverse(G[i]) @ G[best]) @ (inverse(A[i]) @ A[best])
            metres.append(np.linalg.norm(off[:3, 3]))
            degrees.append(angle_deg(off[:3, :3]))
        result["relative"].append(
            dict(
                delta=length,
                unit="m",
                pairs="all",
                own_default=is_own,
                segments=len(metres),
                translation_m=ov_statistics(metres),
                rotation_deg=ov_statistics(degrees),
                further={},
            )
        )
    return result


# ------------------------------------------------------------------ main


def values(texts):
    truth, estimate = Trajectory(texts[0]), Trajectory(texts[1])
    result = {}
    for alignment in ("none", "origin", "se3", "sim3", "scale"):
        result["evo:" + alignment] = evo(estimate, truth, alignment)
    result["evo:se3:40"] = evo(estimate, truth, "se3", 40)
    for alignment in ("none", "posyaw", "se3", "sim3"):
        result["rpg:" + alignment] = rpg(estimate, truth, alignment)
    for text in ("posyaw:1", "se3:1", "posyaw:40", "sim3:40"):
        alignment, n = text.split(":")
        result["rpg:" + text] = rpg(estimate, truth, alignment, int(n))
    for alignment in ("none", "posyaw", "posyawsingle", "se3", "se3single", "sim3"):
        result["ov_eval:" + alignment] = ov_eval(estimate, truth, alignment)
    # Relative errors depend on the scale alone: kept for one rigid alignment and for one with scale.
    for name in result:
        if name not in ("evo:se3", "evo:sim3", "rpg:posyaw", "rpg:sim3", "ov_eval:posyaw", "ov_eval:sim3"):
            del result[name]["relative"]
    # Pairs depend on the tool alone: kept once, as indices into the files.
    matches = {}
    for name, errors in result.items():
        matches[name.split(":")[0]] = errors.pop("matches")
    return dict(lengths_m=LENGTHS_M, matches=matches, definitions=result)


def rounded(value):
    if isinstance(value, float):
        return float("%.12g" % value)
    if isinstance(value, dict):
        return {k: rounded(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [rounded(v) for v in value]
    return value


def json_text(data):
    """One line a definition: small, and readable in a diff."""
    lines = []
    for example, content in data.items():
        lines.append(' "%s": {"lengths_m": %s,' % (example, json.dumps(content["lengths_m"])))
        lines.append('  "matches": {')
        items = list(content["matches"].items())
        lines.append(",\n".join('   "%s": %s' % (k, json.dumps(v, separators=(",", ":"))) for k, v in items))
        lines.append('  }, "definitions": {')
        items = list(content["definitions"].items())
        lines.append(",\n".join('   "%s": %s' % (k, json.dumps(v, separators=(",", ":"))) for k, v in items))
        lines.append("  }},")
    lines[-1] = lines[-1].rstrip(",")
    return "{\n" + "\n".join(lines) + "\n}\n"


def main():
    files = {}
    data = {}
    for name, texts in examples().items():
        files["other_tools_%s_truth.tum" % name], files["other_tools_%s_estimate.tum" % name] = texts
        data[name] = rounded(values(texts))
    files["other_tools_expected.json"] = json_text(data)
    for name, text in files.items():
        path = os.path.join(HERE, name)
        if "--write" in sys.argv:
            with open(path, "w") as f:
                f.write(text)
        elif open(path).read() != text:
            sys.exit("%s differs from what this program computes" % name)


if __name__ == "__main__":
    main()
