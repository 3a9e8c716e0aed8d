"""
Scene files: YAML text in, a checked Scene out.

    file -> reading (plain data) -> schema (keys, types, ranges) -> building and groups -> kernel (geometry)

Each step refuses what it can judge, with a SceneError that says place, rule and value.
"""

from circle_bounce_ros.scene_file.check import check_main
from circle_bounce_ros.scene_file.loading import build_scene, load_scene, read_scene, scene_names

__all__ = ['build_scene', 'check_main', 'load_scene', 'read_scene', 'scene_names']
