// Terrain, fragment stage: depth only. picture.frag shades the ground once a pixel, from its place.
#version 450 core

void main() {}
