// A body's place and colour: filled for each body before it is drawn.
layout(location = 0) uniform mat4 rel_from_mesh;
layout(location = 1) uniform vec4 body_colour;  // w: how glossy, 0 .. 1
