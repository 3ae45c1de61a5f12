// Bodies as the sun sees them, fragment stage: depth only.
#version 450 core

void main() {}
