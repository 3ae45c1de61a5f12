// The rules of materials, and which material cells are of. SPOOR_MIXED is 1 where there are several. Before it, where
// another binding holds the cells' numbers: #define MATERIAL_BINDING.
#ifndef SPOOR_SIM_MATERIALS_GLSL
#define SPOOR_SIM_MATERIALS_GLSL
#include "tables.h"

#ifndef MATERIAL_BINDING
#define MATERIAL_BINDING kBindMaterial
#endif

layout(std140, binding = kBindMaterials) uniform Materials { MaterialEntry materials[kMaterialsMost]; };
#if SPOOR_MIXED
layout(std430, binding = MATERIAL_BINDING) readonly buffer Material { uint material[]; };

int materialOf(int cell) { return int(material[cell >> 2] >> uint(8 * (cell & 3)) & 0xffu); }
/// Of four cells, the first of which is number 4 * quad.
ivec4 materialsOf(int quad) { return ivec4(uvec4(material[quad]) >> uvec4(0u, 8u, 16u, 24u) & uvec4(0xffu)); }
#else
int materialOf(int cell) { return 0; }
ivec4 materialsOf(int quad) { return ivec4(0); }
#endif

#endif
