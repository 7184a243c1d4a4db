import numpy as np

from flowtree.foliage.patch_leaves import patch_leaves
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from tests.trees import hand_made_tree

CAMERA = Camera(0.0, 0.02, (100.0, 190.0), 200, 200)


def test_leaves_come_from_the_painted_tree_in_the_paint_and_from_the_other_beside_it():
    tree = hand_made_tree()
    leaves, count = tree.foliage, len(tree.skeleton.parent)
    right = np.zeros((200, 200), np.float32)
    right[:, 100:] = 1.0
    same = np.arange(count)
    none = np.full(count, -1)
    edit = [PaintedEdit(erase=right)]
    both = patch_leaves(leaves, leaves, [CAMERA], edit, of_plain=same, of_painted=same)
    assert sorted(both.position.tolist()) == sorted(leaves.position.tolist())
    plain = patch_leaves(leaves, leaves, [CAMERA], edit, of_plain=same, of_painted=none)
    painted = patch_leaves(leaves, leaves, [CAMERA], edit, of_plain=none, of_painted=same)
    assert 0 < len(plain.position) < len(leaves.position)
    assert plain.position[:, 0].mean() < painted.position[:, 0].mean()
    assert len(plain.position) + len(painted.position) == len(leaves.position)
    assert patch_leaves(leaves, leaves, [CAMERA], edit, of_plain=none, of_painted=none) is None
    assert patch_leaves(None, None, [CAMERA], edit, of_plain=same, of_painted=same) is None


def test_leaves_follow_their_branches_to_other_numbers():
    tree = hand_made_tree()
    leaves, count = tree.foliage, len(tree.skeleton.parent)
    shifted = np.concatenate([[-1, -1], np.arange(count)])
    nothing = [PaintedEdit(erase=np.zeros((200, 200), np.float32))]
    made = patch_leaves(leaves, None, [CAMERA], nothing, of_plain=shifted, of_painted=shifted)
    assert np.array_equal(made.node, leaves.node + 2)
