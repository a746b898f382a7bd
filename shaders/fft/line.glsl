// The discrete Fourier transform of one line of LENGTH places, by the invocations of one work group: three complex
// lines at once, the channels of a picture.
//
// Stockham's autosort in radix 4, with a last stage of radix 2 where LENGTH is no power of 4; places in registers, passed
// on through shared memory, after Govindaraju, Lloyd, Dotsenko, Smith, Manferdelli 2008, "High Performance Discrete
// Fourier Transforms on Graphics Processors". The last stage leaves every place where it was taken from.
//
// Sign and scale are FFTW's: X[k] = sum over n of x[n] exp(-2 pi i n k / LENGTH). Backwards is the same with real and
// imaginary parts swapped before and after, not divided.

#ifndef LENGTH
#define LENGTH 16
#endif
#define RADIX (LENGTH < 4 ? LENGTH : 4)
#define THREADS (LENGTH / RADIX)
layout(local_size_x = THREADS) in;

layout(std430, binding = 0) readonly buffer Twiddles { vec2 twiddles[LENGTH]; };  // exp(-2 pi i k / LENGTH)

// Registers k of this invocation hold place gl_LocalInvocationID.x + k THREADS, before and after transform_line().
vec3 re[RADIX];
vec3 im[RADIX];

int place_of(int k) { return int(gl_LocalInvocationID.x) + k * THREADS; }

// One part of the line at a time: three channels of 2048 places fill 24 of the 32 KiB that every device has.
shared float passed_on[3 * LENGTH];

void put(int place, vec3 value) {
    passed_on[place] = value.r;
    passed_on[LENGTH + place] = value.g;
    passed_on[2 * LENGTH + place] = value.b;
}
vec3 take(int place) {
    return vec3(passed_on[place], passed_on[LENGTH + place], passed_on[2 * LENGTH + place]);
}

void turn(int k, vec2 by) {
    vec3 turned = re[k] * by.x - im[k] * by.y;
    im[k] = re[k] * by.y + im[k] * by.x;
    re[k] = turned;
}

void swap_registers(int a, int b) {
    vec3 kept = re[a];
    re[a] = re[b];
    re[b] = kept;
    kept = im[a];
    im[a] = im[b];
    im[b] = kept;
}

void butterfly(int a, int b) {
    vec3 kept = re[a];
    re[a] = kept + re[b];
    re[b] = kept - re[b];
    kept = im[a];
    im[a] = kept + im[b];
    im[b] = kept - im[b];
}

// Puts the results of a radix-4 stage over lines of `done` places where the next stage takes its places from.
void pass_on(int done) {
    int j = int(gl_LocalInvocationID.x);
    int first = (j / done) * done * RADIX + j % done;
    barrier();
    for (int k = 0; k < RADIX; ++k) put(first + k * done, re[k]);
    barrier();
    for (int k = 0; k < RADIX; ++k) re[k] = take(place_of(k));
    barrier();
    for (int k = 0; k < RADIX; ++k) put(first + k * done, im[k]);
    barrier();
    for (int k = 0; k < RADIX; ++k) im[k] = take(place_of(k));
}

void transform_line() {
#if LENGTH >= 4
    for (int left = LENGTH; left >= 4; left /= 4) {
        int done = LENGTH / left;
        if (done > 1) pass_on(done / 4);
        int twiddle = (int(gl_LocalInvocationID.x) % done) * (left / 4);
        turn(1, twiddles[twiddle]);
        turn(2, twiddles[2 * twiddle]);
        turn(3, twiddles[3 * twiddle]);
        butterfly(0, 2);
        butterfly(1, 3);
        turn(3, vec2(0.0, -1.0));
        butterfly(0, 1);
        butterfly(2, 3);
        swap_registers(1, 2);
    }
#endif
#if (LENGTH & 0xAAA) != 0  // an odd power of 2
#if LENGTH > 2
    pass_on(LENGTH / 8);
#endif
    for (int b = 0; b < RADIX / 2; ++b) {
        turn(b + RADIX / 2, twiddles[place_of(b)]);
        butterfly(b, b + RADIX / 2);
    }
#endif
}

void swap_parts() {
    for (int k = 0; k < RADIX; ++k) {
        vec3 kept = re[k];
        re[k] = im[k];
        im[k] = kept;
    }
}

void transform_line_back() {
    swap_parts();
    transform_line();
    swap_parts();
}
