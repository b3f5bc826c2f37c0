#version 430 core
// A vertex of a surface, seen along the normal of a contact region: the mean of the points that carry it (a
// tetrahedron's nodes; the vertex itself where the surface is rigid).  Only these points travel; the skin is
// made here, from buffers that never change.
layout(location = 0) in uvec4 carriers;
layout(location = 1) in vec4 weights;
layout(location = 2) in uint range_first;  // of the range of faces that is drawn: number of its first face
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };  // about an origin of their own [m]
uniform uint first_point;  // of this surface
uniform vec4 camera[3];    // rows of the map from there to clip coordinates: orthographic
flat out uint first_face;
invariant gl_Position;  // equal for all triangles with this vertex, whichever draw they are in

void main() {
  vec4 x = vec4(weights.x * points[first_point + carriers.x].xyz +
                    weights.y * points[first_point + carriers.y].xyz +
                    weights.z * points[first_point + carriers.z].xyz +
                    weights.w * points[first_point + carriers.w].xyz,
                1.0);
  gl_Position = vec4(dot(camera[0], x), dot(camera[1], x), dot(camera[2], x), 1.0);
  first_face = range_first;
}
