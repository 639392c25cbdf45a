# SPDX-License-Identifier: BSD-3-Clause
"""What the benchmark reads of a session of corners, and the subset that it makes of one."""
import collections
import glob
import os
import shutil


def asl_folder(session):
    """The folder with camN/: the session itself, or its mav0/."""
    inner = os.path.join(session, "mav0")
    return inner if os.path.isdir(inner) else session


def given_cameras(session):
    """Camera calibration that comes with the session: published (EuRoC) or true (simulated)."""
    for folder in ("kalibr", "truth"):
        path = os.path.join(session, folder, "camchain-imucam.yaml")
        if os.path.exists(path):
            return path
    return None


def _rows(path):
    with open(path, encoding="utf-8") as file:
        for line in file:
            if not line.startswith("#"):
                stamp, corner = line.split(",", 2)[:2]
                yield int(stamp), int(corner), line


def stamps(session):
    """Stamps of camera 0's frames with corners, ascending."""
    path = os.path.join(asl_folder(session), "cam0", "corners.csv")
    return sorted({stamp for stamp, _, _ in _rows(path)})


def frames_with_common_tags(session, least=24):
    """Stamps of the frames in which cameras 0 and 1 share at least `least` tags."""
    tags = collections.defaultdict(lambda: (set(), set()))
    for camera in (0, 1):
        for stamp, corner, _ in _rows(os.path.join(asl_folder(session), f"cam{camera}",
                                                   "corners.csv")):
            tags[stamp][camera].add(corner // 4)
    return {stamp for stamp, (left, right) in tags.items() if len(left & right) >= least}


def subset(session, wanted, out):
    """Camera 0 of the session at these stamps, as a session of its own."""
    source = os.path.join(asl_folder(session), "cam0")
    os.makedirs(os.path.join(out, "cam0"), exist_ok=True)
    shutil.copy(os.path.join(session, "target.yaml"), out)
    if os.path.exists(os.path.join(source, "sensor.yaml")):
        shutil.copy(os.path.join(source, "sensor.yaml"), os.path.join(out, "cam0"))
    with open(os.path.join(out, "cam0", "corners.csv"), "w", encoding="utf-8") as file:
        file.write("#timestamp [ns],corner_id,u [px],v [px]\n")
        file.writelines(line for stamp, _, line in _rows(os.path.join(source, "corners.csv"))
                        if stamp in wanted)
    return out


def images(session):
    """Paths of all images, sorted."""
    folder = asl_folder(session)
    return sorted(path for kind in ("png", "jpg", "jpeg")
                  for path in glob.glob(os.path.join(folder, "cam*", "data", f"*.{kind}")))
