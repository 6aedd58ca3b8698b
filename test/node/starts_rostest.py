#!/usr/bin/env python3
"""The node started with scenes good and bad. It runs, or ends soon, saying what is wrong."""
import concurrent.futures
import functools
import os
import random
import shlex
import signal
import subprocess
import tempfile
import unittest

import roslib.packages
import rospkg
import rospy
import yaml
from roslaunch.config import ROSLaunchConfig
from rosgraph_msgs.msg import Log
from roslaunch.xmlloader import XmlLoader
from rostest_support import PATIENCE, Inbox, run, wait_until

from organ_collision.msg import MeshInfoArray

LONGEST_START = 10.0  # [s]
LIVER = "package://organ_collision/meshes/liver.obj"
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
GARBAGE = random.Random(1).randbytes(1000)
NODE = roslib.packages.find_node("organ_collision", "organ_collision_node")[0]


def organ(**fields):
    return {"name": "liver", "frame": "liver", "mesh": LIVER, **fields}


def instrument(**fields):
    return {"name": "left", "frame": "left_tip", **fields}


def scene(**fields):
    return {"organs": [organ()], "instruments": [instrument()], **fields}


def start(name, described, **options):
    """A node of this name with this scene; none: without. Options: as Popen's."""
    if described is not None:
        rospy.set_param(f"/{name}/scene", described)
    return subprocess.Popen([NODE, f"__name:={name}"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                            **options)


def threads(process):
    return [int(thread) for thread in os.listdir(f"/proc/{process.pid}/task")]


def policies(process):
    """How the kernel schedules each of its threads."""
    return [os.sched_getscheduler(thread) for thread in threads(process)]


def nices(process):
    return {os.getpriority(os.PRIO_PROCESS, thread) for thread in threads(process)}


def written(folder, name, content):
    """The path of a new file."""
    path = os.path.join(folder, name)
    with open(path, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())
    return path


def bad_meshes(folder):
    """Files that nobody should accept, and what the error names beside the path."""
    bad = functools.partial(written, folder)
    ply = "ply\nformat {}\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" \
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    points = "0 0 0\n1 0 0\n0 1 0\n"
    return {
        "empty": (bad("nothing.obj", ""), "is empty"),
        "without_triangles": (bad("points.obj", "v 0 0 0\nv 1 0 0\n"), "triangle"),
        "not_a_mesh": (bad("garbage.obj", GARBAGE), ""),
        "not_a_ply": (bad("garbage.ply", GARBAGE), ""),
        "not_an_stl": (bad("garbage.stl", GARBAGE), ""),
        "not_a_collada": (bad("garbage.dae", "<COLLADA><mesh"), ""),
        "of_unknown_kind": (bad("garbage.docx", GARBAGE), ""),
        "nan_vertex": (bad("nan.obj", TRIANGLE.replace("v 1 0 0", "v nan 0 0")), "(nan, "),
        "infinite_vertex": (bad("infinite.obj", TRIANGLE.replace("v 1 0 0", "v inf 0 0")), "(inf, "),
        "index_out_of_range": (bad("index.obj", TRIANGLE.replace("f 1 2 3", "f 1 2 4")), "line 4: a face names vertex 4 of 3"),
        "ply_index_negative": (bad("negative.ply", ply.format("ascii 1.0") + points + "3 0 1 -1\n"), "vertex -1"),
        "ply_index_out_of_range": (bad("large.ply", ply.format("ascii 1.0") + points + "3 0 1 7\n"), "vertex 7 of 3"),
        "ply_cut_off": (bad("cut.ply", ply.format("binary_little_endian 1.0").encode() + b"\0" * 20), ""),
        "off_cut_off": (bad("cut.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n"), ""),
        "stl_cut_off": (bad("cut.stl", b"\0" * 80 + b"\xff\xff\xff\x0f" + b"\0" * 50), ""),
    }


def bad_scenes(folder):
    """Scenes that are refused, and what the error names."""
    outside = written(folder, "outside.obj", TRIANGLE)
    root = os.path.join(folder, "root")
    os.mkdir(root)
    link = os.path.join(root, "link.obj")
    os.symlink(outside, link)
    missing = os.path.join(folder, "missing.obj")

    cases = {
        "no_scene": (None, ["no_scene/scene"]),
        "not_a_map": ("liver", ["scene", "liver"]),
        "no_organs": ({"instruments": []}, ["scene.organs"]),
        "empty_organs": (scene(organs=[]), ["scene.organs"]),
        "unknown_key": (scene(colour="red"), ["scene.colour"]),
        "unknown_key_of_an_organ": (scene(organs=[organ(colour="red")]), ["scene.organs[0].colour"]),
        "unknown_key_of_an_instrument":
            (scene(instruments=[instrument(size=0.1)]), ["scene.instruments[0].size"]),
        "radius_of_a_point": (scene(instruments=[instrument(radius=0.1)]), ["scene.instruments[0].radius"]),
        "sphere_without_size":
            (scene(instruments=[instrument(shape="sphere")]), ["scene.instruments[0].radius", "missing"]),
        "negative_radius":
            (scene(instruments=[instrument(shape="sphere", radius=-0.003)]),
             ["scene.instruments[0].radius", "-0.003"]),
        "capsule_without_ends":
            (scene(instruments=[instrument(shape="capsule", radius=0.003)]), ["scene.instruments[0].ends"]),
        "missing_mesh_of_an_instrument":
            (scene(instruments=[instrument(shape="mesh", mesh=missing)]), ["scene.instruments[0].mesh", missing]),
        "instrument_with_itself": (scene(pairs=[["left", "left"]]), ["scene.pairs[0]", "left"]),
        "pair_of_one": (scene(pairs=[["left"]]), ["scene.pairs[0]"]),
        "unknown_key_of_accuracy": (scene(accuracy={"epsilon": 0.1}), ["scene.accuracy.epsilon"]),
        "unknown_shape":
            (scene(instruments=[instrument(shape="hook")]), ["scene.instruments[0].shape", "hook"]),
        "no_frame": (scene(organs=[{"name": "liver", "mesh": LIVER}]), ["scene.organs[0].frame"]),
        "no_mesh": (scene(organs=[{"name": "liver", "frame": "liver"}]), ["scene.organs[0]", "mesh"]),
        "negative_scale": (scene(organs=[organ(scale=-1.0)]), ["scene.organs[0].scale", "-1"]),
        "zero_rate": (scene(rate=0), ["scene.rate: 0,"]),
        "rate_in_words": (scene(rate="fast"), ["scene.rate", "fast"]),
        "negative_stale_after": (scene(stale_after=-0.1), ["scene.stale_after", "-0.1"]),
        "negative_max_distance": (scene(max_distance=-1), ["scene.max_distance", "-1"]),
        "negative_error": (scene(accuracy={"max_relative_error": -0.5}), ["scene.accuracy.max_relative_error"]),
        "negative_leaves": (scene(accuracy={"max_leaves": -1}), ["scene.accuracy.max_leaves", "-1"]),
        "error_beyond_dynamic_reconfigure":
            (scene(accuracy={"max_relative_error": 20.0}), ["scene.accuracy.max_relative_error", "20", "10"]),
        "pair_of_strangers": (scene(pairs=[["left", "spleen"]]), ["scene.pairs[0]", "spleen"]),
        "name_twice": (scene(organs=[organ(), organ()]), ["scene.organs[1].name", "liver"]),
        "unknown_package":
            (scene(organs=[organ(mesh="package://no_such_package/liver.obj")]), ["no_such_package"]),
        "missing_mesh": (scene(organs=[organ(mesh=missing)]), [missing]),
        "missing_mesh_in_package":
            (scene(organs=[organ(mesh=LIVER + "x")]),
             [os.path.join(rospkg.RosPack().get_path("organ_collision"), "meshes", "liver.objx")]),
        "folder_as_mesh": (scene(organs=[organ(mesh=folder)]), [folder]),
        "outside_mesh_root": (scene(organs=[organ(mesh=outside)], mesh_root=root), [outside, root]),
        "link_out_of_mesh_root": (scene(organs=[organ(mesh=link)], mesh_root=root), [outside, root]),
        "missing_mesh_root": (scene(mesh_root=missing), [missing]),
        "link_without_description":
            (scene(organs=[{"name": "liver", "frame": "liver", "link": "liver"}]),
             ["scene.organs[0].link", "robot_description"]),
    }
    for what, (path, name) in bad_meshes(folder).items():
        cases["mesh_" + what] = (scene(organs=[organ(mesh=path)]), [path, name])
    return cases


def launched(file, *arguments):
    """What roslaunch makes of a launch file of this package: nothing is started."""
    config = ROSLaunchConfig()
    path = os.path.join(rospkg.RosPack().get_path("organ_collision"), file)
    XmlLoader().load(path, config, argv=list(arguments), verbose=False)
    return config


def node_of(config, name):
    return next(node for node in config.nodes if node.name == name)


class Starts(unittest.TestCase):
    def complaint(self, name, described, wanted):
        """What is wrong with this start; empty if nothing is."""
        process = start(name, described)
        try:
            output, _ = process.communicate(timeout=LONGEST_START)
        except subprocess.TimeoutExpired:
            process.kill()
            return f"{name}: runs on, saying {process.communicate()[0]}"
        if process.returncode <= 0:  # negative: killed by a signal
            return f"{name}: ends with {process.returncode}, saying {output}"
        silent = [word for word in wanted if word not in output]
        return f"{name}: does not name {silent}, but says {output}" if silent else ""

    def test_a_bad_scene_ends_the_node_with_an_error_that_names_the_thing(self):
        with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(4) as pool:
            complaints = "\n".join(filter(None, pool.map(lambda case: self.complaint(case[0], *case[1]),
                                                         bad_scenes(os.path.realpath(folder)).items())))
        if complaints:
            self.fail(complaints)

    def test_what_stands_beside_the_scene_ends_the_node_with_an_error_that_names_it(self):
        for key, value in (("instruments", []), ("max_distance", 0.05)):
            name = f"beside_{key}"
            rospy.set_param(f"/{name}/{key}", value)
            for described in (scene(), None):
                self.assertEqual(self.complaint(name, described, [f"/{name}/{key}", "scene"]), "")

    def test_what_is_said_at_the_start_and_at_an_early_end_reaches_rosout(self):
        rosout = subprocess.Popen(roslib.packages.find_node("rosout", "rosout"))  # rostest starts none
        running = None
        try:
            log = Inbox("/rosout_agg", Log)
            start("ends_early", scene(organs=[organ(mesh="/nowhere.obj")])).wait(LONGEST_START)
            log.wait_for(lambda said: said.name == "/ends_early" and said.level == Log.FATAL and "/nowhere" in said.msg)
            running = start("runs", scene())
            log.wait_for(lambda said: said.name == "/runs" and said.msg.startswith("liver: building the hierarchy"))
        finally:
            for process in filter(None, (running, rosout)):
                process.terminate()
                process.wait(LONGEST_START)

    def test_a_name_that_ros_refuses_ends_the_node_with_an_error(self):
        for argument in ("__name:=a/b", "~contacts:=bad-name"):
            ended = subprocess.run([NODE, argument], capture_output=True, text=True, timeout=LONGEST_START, check=False)
            self.assertEqual(ended.returncode, 1, ended.stderr)
            self.assertIn(argument.partition(":=")[2], ended.stdout + ended.stderr)

    def check_bad_parameters(self, program, cases):
        """Each case: arguments, the parameter that the error names, and how its value is told."""
        path = roslib.packages.find_node("organ_collision", program)[0]

        def complaint(number, arguments, parameter, value):
            name = f"bad_{program}_{number}"
            try:
                ended = subprocess.run([path, f"__name:={name}", *arguments], capture_output=True, text=True,
                                       timeout=LONGEST_START, check=False)
            except subprocess.TimeoutExpired:
                return f"{arguments}: runs on"
            said = "is not set" if value is None else f"is {value}"
            wanted = f"{program}: /{name}/{parameter} {said}, but it must be "
            if ended.returncode == 1 and ended.stderr.startswith(wanted) and ended.stderr.count("\n") == 1:
                return ""
            return f"{arguments}: ends with {ended.returncode}, saying {ended.stderr}"

        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            complaints = list(filter(None, pool.map(lambda case: complaint(case[0], *case[1]), enumerate(cases))))
        self.assertEqual(complaints, [])

    def test_the_crtk_relay_ends_with_an_error_that_names_the_wrong_parameter(self):
        self.check_bad_parameters("crtk_relay", [
            ([], "arms", None),
            (["_arms:=[PSM1]"], "arms", "['PSM1']"),
            (["_arms:={}"], "arms", "{}"),
            (["_arms:={PSM1: 5}"], "arms/PSM1", "5"),
            (["_arms:={CRTK: {psm1: 5}}"], "arms/CRTK/psm1", "5"),
            (["_arms:={CRTK: {psm1: {}}}"], "arms/CRTK/psm1", "{}"),
            (["_arms:={PSM1: ''}"], "arms/PSM1", "''"),
            (["_arms:={PSM-1: tip}"], "arms", "{'PSM-1': 'tip'}"),
            (["_arms:={'': tip}"], "arms", "{'': 'tip'}"),
            (["_arms:={PSM1: tip, PSM2: tip}"], "arms", "{'PSM1': 'tip', 'PSM2': 'tip'}"),
            (["_arms:={PSM1: tip, PSM2: /tip}"], "arms", "{'PSM1': 'tip', 'PSM2': '/tip'}"),
            (["_arms:={PSM1: tip}", "_base:=5"], "base", "5"),
            (["_arms:={PSM1: tip}", "_base:=''"], "base", "''"),
        ])

    def test_the_sweep_ends_with_an_error_that_names_the_wrong_parameter(self):
        good = {"parent": "grid", "child": "tip", "low": "[0, 0, 0]", "high": "[1, 1, 0]"}
        wrong = [
            ("low", None, None),
            ("low", "0.5", "0.5"),
            ("low", "[0, 0]", "[0, 0]"),
            ("low", "[0, zero, 0]", "[0, 'zero', 0]"),
            ("low", "[0, 0, .nan]", "[0, 0, nan]"),
            ("high", "[0, 1, 0]", "[0, 1, 0]"),
            ("rate", "0", "0"),
            ("rate", "fast", "'fast'"),
            ("child", None, None),
            ("parent", None, None),
            ("parent", "''", "''"),
            ("parent", "tip", "'tip'"),
        ]
        self.check_bad_parameters("sweep", [
            ([f"_{key}:={text}" for key, text in {**good, name: value}.items() if text is not None], name, told)
            for name, value, told in wrong])

    def test_an_unknown_link_ends_the_node_with_the_key_and_the_links_that_there_are(self):
        rospy.set_param("/robot_description", '<robot name="r"><link name="arm"/></robot>')
        try:
            described = scene(instruments=[instrument(link="leg")])
            complaint = self.complaint("unknown_link", described, ["scene.instruments[0].link", "leg", "arm"])
            self.assertEqual(complaint, "")
            described = scene(instruments=[instrument(link="arm")])
            complaint = self.complaint("bare_link", described, ["scene.instruments[0].link", "no <collision>"])
            self.assertEqual(complaint, "")
        finally:
            rospy.delete_param("/robot_description")

    def check_that_it_runs(self, name, described, while_it_runs=lambda process: None, **options):
        """Returns the names of its organs."""
        process = start(name, described, **options)
        try:
            infos = rospy.wait_for_message(f"/{name}/mesh_info", MeshInfoArray, PATIENCE)
            while_it_runs(process)
            self.assertIsNone(process.poll())
        finally:
            process.send_signal(signal.SIGINT)
            output, _ = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 0, output)
        return [info.organ for info in infos.meshes]

    def test_a_good_scene_runs_until_it_is_stopped_and_ends_without_an_error(self):
        self.assertEqual(self.check_that_it_runs("good", scene()), ["liver"])

    def test_real_time_priority_is_for_the_threads_that_answer_tips(self):
        def check(process):
            wait_until(lambda: policies(process).count(os.SCHED_OTHER) >= 5, "threads for services and updates")
            self.assertEqual(os.sched_getscheduler(process.pid), os.SCHED_FIFO)

        priority = functools.partial(os.sched_setscheduler, 0, os.SCHED_FIFO, os.sched_param(1))
        try:
            self.check_that_it_runs("urgent", scene(), check, preexec_fn=priority)
        except subprocess.SubprocessError:
            self.skipTest("this user may not give it")

    def test_who_updates_organs_and_who_rebuilds_them_steps_back(self):
        own = os.getpriority(os.PRIO_PROCESS, 0)
        if own >= 5:
            self.skipTest("all of it steps back")

        def check(process):
            wait_until(lambda: nices(process) == {own, 5, 19}, "threads that step back")
            self.assertEqual(os.getpriority(os.PRIO_PROCESS, process.pid), own)

        self.check_that_it_runs("modest", scene(), check)

    def test_every_scene_in_config_runs(self):
        config = os.path.join(rospkg.RosPack().get_path("organ_collision"), "config")
        shipped = {}
        for file in os.listdir(config):
            if file.endswith(".yaml"):
                with open(os.path.join(config, file)) as text:
                    shipped[file.replace(".yaml", "")] = (yaml.safe_load(text) or {}).get("scene")
        scenes = {name: described for name, described in shipped.items() if described}
        self.assertIn("demo", scenes)
        for name, described in scenes.items():
            self.assertEqual(self.check_that_it_runs(name, described),
                             [each["name"] for each in described["organs"]])

    def test_rviz_shows_the_frame_of_the_scene(self):
        for file in ("launch/demo.launch", "launch/crtk.launch", "examples/abdomen.launch", "examples/paper.launch",
                     "examples/two_instruments.launch"):
            with self.subTest(file):
                config = launched(file, "rviz:=true")
                organs = config.params["/organ_collision/scene/organs"].value
                frame = config.params.get("/organ_collision/scene/frame")
                options = shlex.split(node_of(config, "rviz").args)  # as roslaunch does
                with open(options[options.index("-d") + 1]) as text:
                    shown = yaml.safe_load(text)["Visualization Manager"]["Global Options"]["Fixed Frame"]
                if "-f" in options:
                    shown = options[options.index("-f") + 1]
                self.assertEqual(shown, frame.value if frame else organs[0]["frame"])

    def test_organ_collision_launch_heeds_its_arguments(self):
        config = launched("launch/organ_collision.launch", "prefix:=nice -n 1", "output:=log", "rviz:=true",
                          "rviz_config:=my own.rviz", "rviz_args:=-f liver")
        node, rviz = node_of(config, "organ_collision"), node_of(config, "rviz")
        self.assertEqual((node.launch_prefix, node.output), ("nice -n 1", "log"))
        self.assertEqual(shlex.split(rviz.args), ["-d", "my own.rviz", "-f", "liver"])
        self.assertEqual((node.required, node.respawn, rviz.required), (True, False, True))
        self.assertEqual(config.clear_params, ["/organ_collision/"], "a scene that was there before leaves no keys")
        config = launched("launch/organ_collision.launch", "respawn:=true")
        node, = config.nodes
        self.assertEqual((node.launch_prefix, node.output), (None, "screen"))
        self.assertEqual((node.required, node.respawn), (False, True))

    def test_a_launch_leaves_no_parameters_to_the_next(self):
        package = rospkg.RosPack().get_path("organ_collision")
        files = [os.path.join(folder, file) for folder in ("launch", "examples")
                 for file in os.listdir(os.path.join(package, folder)) if file.endswith(".launch")]
        self.assertIn("examples/two_nodes.launch", files)
        for file in files:
            config = launched(file)
            own = {f"/{node.name}/" for node in config.nodes if node.package == "organ_collision"}
            self.assertEqual(own - set(config.clear_params), set(), file)

    def test_crtk_launch_heeds_its_arguments(self):
        with tempfile.TemporaryDirectory() as folder:
            path = written(folder, "scene.yaml", yaml.safe_dump({"scene": scene(rate=77)}))
            params = launched("launch/crtk.launch", "arms:={left: left_tip}", "base:=cart", f"scene:={path}").params
        relay = {name: param.value for name, param in params.items() if name.startswith("/crtk_relay/")}
        self.assertEqual(relay, {"/crtk_relay/arms/left": "left_tip", "/crtk_relay/base": "cart"})
        self.assertEqual(params["/organ_collision/scene/rate"].value, 77)

    def test_demo_launch_hands_its_arguments_to_rviz(self):
        config = launched("launch/demo.launch", "rviz_config:=my own.rviz", "rviz_args:=-f liver")
        self.assertEqual(shlex.split(node_of(config, "rviz").args), ["-d", "my own.rviz", "-f", "liver"])


if __name__ == "__main__":
    run(Starts)
