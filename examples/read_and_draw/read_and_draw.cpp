// read_and_draw.cpp: from a file of particles to a PNG, in C++.
//
//     read_and_draw PARTICLES OUTPUT.png
#include <meniscus/io.h>
#include <meniscus/meniscus.h>

#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <vector>

namespace
{

// Every object of the library has its destroy function, which unique_ptr calls.
struct destroy {
    void operator()(mns_particle_set *set) const { mns_particle_set_destroy(&set); }
    void operator()(mns_renderer *renderer) const { mns_renderer_destroy(&renderer); }
};
using particle_set = std::unique_ptr<mns_particle_set, destroy>;
using renderer = std::unique_ptr<mns_renderer, destroy>;

void check(mns_result result, const char *text)
{
    if (result != MNS_OK) {
        throw std::runtime_error(text);
    }
}

void check(mns_result result, const renderer &source) { check(result, mns_renderer_message(source.get())); }

particle_set read(const char *path)
{
    mns_particle_set *set = nullptr;
    mns_message message;
    check(mns_particle_set_read(&set, path, nullptr, &message), message.text);
    return particle_set(set);
}

renderer create_renderer()
{
    mns_renderer *created = nullptr;
    mns_message message;
    check(mns_renderer_create(&created, nullptr, &message), message.text);
    return renderer(created);
}

// A camera that sees all of the fluid, but for a few lost drops.
mns_camera frame_fluid(const mns_particles &particles, int width, int height)
{
    mns_measure measure;
    mns_message message;
    check(mns_particles_measure(&particles, nullptr, &measure, &message), message.text);
    mns_camera camera;
    mns_camera_init(&camera, width, height);
    check(mns_camera_frame(&camera, measure.inner_min, measure.inner_max, measure.radius, MNS_AXIS_Y, 45), "there is nothing to frame");
    return camera;
}

void read_and_draw(const char *input, const char *output)
{
    const int width = 1280, height = 720;
    const particle_set set = read(input);
    const mns_particles &particles = *mns_particle_set_particles(set.get());
    const mns_camera camera = frame_fluid(particles, width, height);
    std::vector<std::uint8_t> rgba(std::size_t(4) * width * height);
    const mns_image image = {rgba.data(), 0, width, height, 4, MNS_PIXEL_U8};

    const renderer drawing = create_renderer();
    check(mns_renderer_prepare(drawing.get(), &particles), drawing);
    const mns_output beauty = {MNS_LAYER_BEAUTY, image};
    mns_frame frame; // no params, no scene: all defaults, under the library's own sky
    mns_frame_init(&frame);
    frame.camera = &camera;
    frame.outputs = &beauty;
    frame.output_count = 1;
    check(mns_renderer_draw(drawing.get(), &frame), drawing);

    mns_message message;
    check(mns_image_write(output, &image, &message), message.text);
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 3) {
        std::fprintf(stderr, "usage: read_and_draw PARTICLES OUTPUT.png\n");
        return 2;
    }
    try {
        read_and_draw(argv[1], argv[2]);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "read_and_draw: %s\n", error.what());
        return 1;
    }
    return 0;
}
