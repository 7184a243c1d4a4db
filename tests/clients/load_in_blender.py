"""Run by a Python that has bpy: imports each GLB or USD into an empty Blender and prints what it became."""

import json
import sys

import bpy

reports = []
for path in sys.argv[1:]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if path.endswith(".glb"):
        bpy.ops.import_scene.gltf(filepath=path)
    else:
        bpy.ops.wm.usd_import(filepath=path)
    graph = bpy.context.evaluated_depsgraph_get()
    low, high = [float("inf")] * 3, [float("-inf")] * 3
    meshes: dict[str, int] = {}
    for instance in graph.object_instances:
        thing = instance.object
        if thing.type != "MESH" or thing.name.startswith("Icosphere"):
            continue
        mesh = thing.data
        mesh.calc_loop_triangles()
        name = thing.name
        meshes[name] = meshes.get(name, 0) + len(mesh.loop_triangles)
        for vertex in mesh.vertices:
            place = instance.matrix_world @ vertex.co
            for axis in range(3):
                low[axis] = min(low[axis], place[axis])
                high[axis] = max(high[axis], place[axis])
    reports.append(
        {
            "meshes": meshes,
            "bounds": [low, high],
            "bones": sum(len(armature.bones) for armature in bpy.data.armatures),
            "actions": [action.name for action in bpy.data.actions],
            "materials": sorted(material.name for material in bpy.data.materials),
            "attributes": sorted(
                {each.name for mesh in bpy.data.meshes for each in mesh.attributes if each.name[0] == "_"}
            ),
        }
    )
sys.stdout.write("\nREPORTS " + json.dumps(reports) + "\n")
