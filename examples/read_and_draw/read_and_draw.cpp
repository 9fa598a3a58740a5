// read_and_draw.cpp: reads a particle file, frames it, draws it, writes a PNG. Needs meniscus::io.
//
//     read_and_draw PARTICLES PICTURE.png
#include <meniscus/io.h>
#include <meniscus/meniscus.h>

#include <cstdint>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <vector>

namespace {

struct SetDeleter {
    void operator()(mns_particle_set *set) const { mns_particle_set_destroy(&set); }
};
struct RendererDeleter {
    void operator()(mns_renderer *renderer) const { mns_renderer_destroy(&renderer); }
};
using Set = std::unique_ptr<mns_particle_set, SetDeleter>;
using Renderer = std::unique_ptr<mns_renderer, RendererDeleter>;

void check(mns_result result, const char *text)
{
    if (result != MNS_OK) {
        throw std::runtime_error(text);
    }
}

Set read(const char *path)
{
    mns_message message;
    mns_particle_set *set = nullptr;
    check(mns_particle_set_read(&set, path, nullptr, &message), message.text);
    return Set(set);
}

Renderer create_renderer()
{
    mns_message message;
    mns_renderer *renderer = nullptr;
    check(mns_renderer_create(&renderer, nullptr, &message), message.text);
    return Renderer(renderer);
}

void draw(const char *particles_path, const char *picture_path)
{
    const int width = 1280, height = 720;
    Set set = read(particles_path);
    Renderer renderer = create_renderer();
    check(mns_renderer_prepare(renderer.get(), mns_particle_set_particles(set.get())), mns_renderer_message(renderer.get()));

    // What the renderer measured frames the picture.
    mns_stats stats;
    mns_stats_init(&stats);
    mns_renderer_stats(renderer.get(), &stats);
    mns_camera camera;
    mns_camera_init(&camera, width, height);
    check(mns_camera_frame(&camera, stats.measure.inner_min, stats.measure.inner_max, stats.measure.radius, MNS_AXIS_Y, 45),
          "the particles cannot be framed");

    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * height * 4);
    mns_output output = {MNS_LAYER_BEAUTY, {pixels.data(), 0, width, height, 4, MNS_PIXEL_U8}};
    mns_frame frame;
    mns_frame_init(&frame);
    frame.camera = &camera;
    frame.outputs = &output;
    frame.output_count = 1;
    check(mns_renderer_draw(renderer.get(), &frame), mns_renderer_message(renderer.get()));

    mns_message message;
    check(mns_image_write(picture_path, &output.image, &message), message.text);
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 3) {
        std::cerr << "usage: read_and_draw PARTICLES PICTURE.png\n";
        return 2;
    }
    try {
        draw(argv[1], argv[2]);
    } catch (const std::exception &error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
    return 0;
}
