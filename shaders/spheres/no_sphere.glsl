// The lists of transparent things number spheres from 0; what is none has this bit and the place of its light.
const uint no_sphere = 0x80000000u;
