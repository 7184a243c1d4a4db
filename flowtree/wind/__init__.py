"""What moves a tree in the wind: weights for shaders, joints, and a swaying of the joints."""
