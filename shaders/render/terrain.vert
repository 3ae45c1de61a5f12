// Terrain, vertex stage: hands a patch on. In: one vertex a patch. Out: first cell x, y; level; flags.
#version 450 core

layout(location = 0) in ivec4 patch_in;
out ivec4 patch_vertex;

void main() { patch_vertex = patch_in; }
