"""Rotations as quaternions, Euler angles and matrices, with tf_transformations' names and conventions.

Angles are radians, quaternions (x, y, z, w). Axes of Euler angles are named as there: ``s`` for static or
``r`` for rotating axes, then their order (K. Shoemake, Graphics Gems IV, "Euler angle conversion").
Functions of quaternions and angles return tuples; matrices are numpy's, imported when one is asked for.
"""

from tf_transformations._matrices import (
    compose_matrix,
    concatenate_matrices,
    decompose_matrix,
    euler_matrix,
    identity_matrix,
    inverse_matrix,
    is_same_transform,
    quaternion_matrix,
    random_quaternion,
    random_rotation_matrix,
    random_vector,
    reflection_from_matrix,
    reflection_matrix,
    rotation_from_matrix,
    rotation_matrix,
    scale_from_matrix,
    scale_matrix,
    shear_matrix,
    translation_from_matrix,
    translation_matrix,
    unit_vector,
    vector_norm,
)
from tf_transformations._quaternions import (
    euler_from_matrix,
    euler_from_quaternion,
    quaternion_about_axis,
    quaternion_conjugate,
    quaternion_from_euler,
    quaternion_from_matrix,
    quaternion_inverse,
    quaternion_multiply,
    quaternion_slerp,
)
