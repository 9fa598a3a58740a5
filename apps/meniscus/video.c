/* video.c: pictures to a video (POSIX). Every way leads over YUV4MPEG2: a file, standard output, or the pipe to ffmpeg. */
#include "video.h"

#include "inputs.h"
#include "process.h"
#include "program.h"
#include "yuv.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct video {
    const char *path;
    char *beside;            /* where it is made; NULL: standard output, or path itself, which is no plain file */
    struct process *encoder; /* NULL: none */
    FILE *file;              /* of a .y4m; NULL: none */
    bool failed;
    int width, height; /* of the planes */
    uint8_t *planes;
    size_t bytes; /* of the planes */
    size_t pictures;
};

/* ---- what can be made ---- */

static bool is_y4m(const char *path) { return !strcmp(path, "-") || name_has_extension(path, ".y4m"); }

/* ffmpeg's name of the container; NULL: none of ours. */
static const char *container_of(const char *path)
{
    return name_has_extension(path, ".mp4")    ? "mp4"
           : name_has_extension(path, ".mkv")  ? "matroska"
           : name_has_extension(path, ".webm") ? "webm"
                                               : NULL;
}

bool video_is(const char *path) { return name_has_extension(path, ".y4m") || container_of(path); }

/* An encoder of ffmpeg, and its settings beside --crf: as good as people expect, at a speed that keeps up with drawing. */
struct encoder {
    enum codec codec;
    const char *name;
    double crf, crf_most;
    const char *settings[9]; /* ends with NULL */
};

/* The first of a codec that ffmpeg has is taken. libsvtav1, several times faster, comes second: its version 1.4 hangs now and then at the end of a
 * short video. */
static const struct encoder encoders[] = {
    /* It holds 10 pictures back, not 40: a short sequence would be encoded after it is drawn. That costs 0.6 dB of 51. */
    {CODEC_H264, "libx264", 18, 51, {"-preset", "medium", "-rc-lookahead", "10"}},
    {CODEC_VP9, "libvpx-vp9", 28, 63, {"-b:v", "0", "-deadline", "good", "-cpu-used", "4", "-row-mt", "1"}},
    {CODEC_AV1, "libaom-av1", 28, 63, {"-b:v", "0", "-cpu-used", "6", "-row-mt", "1", "-tiles", "2x2"}},
    {CODEC_AV1, "libsvtav1", 28, 63, {"-preset", "8"}},
};

enum { ENCODERS = sizeof(encoders) / sizeof(encoders[0]) };

static const char *const codec_names[] = {[CODEC_AUTO] = "auto", [CODEC_H264] = "h264", [CODEC_VP9] = "vp9", [CODEC_AV1] = "av1"};

static enum codec codec_of(const char *path, const struct options *options)
{
    return options->codec != CODEC_AUTO ? options->codec : name_has_extension(path, ".webm") ? CODEC_VP9 : CODEC_H264;
}

/* What `ffmpeg -encoders` prints, or NULL. *error: 0 or an errno. The caller frees it. */
static char *list_encoders(int *error)
{
    enum { SIZE = 1 << 17 }; /* bytes; it prints about 20 KB */
    static const char *const arguments[] = {"ffmpeg", "-hide_banner", "-loglevel", "error", "-encoders", NULL};
    struct process *process;
    struct process_end end;
    char *text = malloc(SIZE);
    *error = text ? process_start(&process, arguments, PROCESS_READ) : ENOMEM;
    if (*error) {
        free(text);
        return NULL;
    }
    text[process_read(process, text, SIZE - 1)] = '\0';
    process_finish(process, &end);
    return text;
}

/* Whether a word stands in a list of words. */
static bool has_word(const char *text, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = strstr(text, word); at; at = strstr(at + 1, word)) {
        if (at > text && at[-1] == ' ' && (at[length] == ' ' || at[length] == '\n')) {
            return true;
        }
    }
    return false;
}

static const struct encoder *first_of(enum codec codec, const char *list)
{
    for (size_t i = 0; i < ENCODERS; i++) {
        if (encoders[i].codec == codec && (!list || has_word(list, encoders[i].name))) {
            return &encoders[i];
        }
    }
    return NULL;
}

/* The encoder to use; NULL after telling why. */
static const struct encoder *find_encoder(const char *path, enum codec codec, struct mns_message *message)
{
    int error;
    char *list = list_encoders(&error);
    const struct encoder *encoder = list ? first_of(codec, list) : NULL;
    if (!list && error == ENOENT) {
        snprintf(message->text, sizeof(message->text),
                 "%s: needs the program ffmpeg, which is not here; install it (Debian, Ubuntu: apt-get install ffmpeg), or write pictures "
                 "(-o out_%%04d.png) or a .y4m",
                 path);
    } else if (!list) {
        snprintf(message->text, sizeof(message->text), "%s: ffmpeg cannot be started: %s", path, strerror(error));
    } else if (!encoder) {
        snprintf(message->text, sizeof(message->text),
                 "%s: the ffmpeg that is here has no encoder for %s (%s); install one that has, choose another --codec, or write a .y4m",
                 path, codec_names[codec], first_of(codec, NULL)->name);
    }
    free(list);
    return encoder;
}

int video_check(const char *path, const struct options *options, const struct encoder **encoder)
{
    *encoder = NULL;
    if (options->params.background == MNS_BACKGROUND_TRANSPARENT) {
        return program_usage("%s: a video cannot be transparent; choose another --background, or write pictures", path);
    }
    if (is_y4m(path)) {
        return options->codec == CODEC_AUTO && options->crf < 0 ? STATUS_DONE
                                                                : program_usage("--codec and --crf are for .mp4, .mkv and .webm");
    }
    enum codec codec = codec_of(path, options);
    if (codec == CODEC_H264 && name_has_extension(path, ".webm")) {
        return program_usage("%s: .webm holds vp9 or av1; h264 goes into .mp4 or .mkv", path);
    }
    struct mns_message message;
    *encoder = find_encoder(path, codec, &message);
    if (!*encoder) {
        return program_fail("%s", message.text);
    }
    return options->crf <= (*encoder)->crf_most ? STATUS_DONE
                                                : program_usage("--crf: %g is too much for %s; it must be 0 (best) to %g", options->crf,
                                                                codec_names[codec], (*encoder)->crf_most);
}

/* ---- opening ---- */

struct words {
    const char *list[64]; /* ends with NULL */
    size_t count;
};

static void add_words(struct words *words, const char *const *list)
{
    for (size_t i = 0; list[i]; i++) {
        words->list[words->count++] = list[i];
    }
}

/* "file:PATH", so that a colon in the name starts no protocol; NULL: out of memory. */
static char *url_of(const char *path)
{
    size_t size = strlen(path) + 6;
    char *url = malloc(size);
    if (url) {
        snprintf(url, size, "file:%s", path);
    }
    return url;
}

/* Starts ffmpeg on a YUV4MPEG2 stream. 0 or an errno. */
static int start_encoder(struct video *video, const struct encoder *encoder, const struct options *options)
{
    /* The stream has no tags of its own; the frames get them, and so does the file. */
    static const char *const input[] = {
        "ffmpeg",   "-hide_banner", "-loglevel", "error",
        "-nostdin", "-y",           "-f",        "yuv4mpegpipe",
        "-i",       "pipe:0",       "-vf",       "setparams=range=tv:color_primaries=bt709:color_trc=bt709:colorspace=bt709",
        NULL};
    static const char *const tags[] = {"-color_range", "tv",    "-color_primaries", "bt709",   "-color_trc", "bt709",
                                       "-colorspace",  "bt709", "-pix_fmt",         "yuv420p", NULL};
    static const char *const front[] = {"-movflags", "+faststart", NULL}; /* its index first, so that it plays while it loads */
    const char *container = container_of(video->path);
    char crf[32], threads[32], *url = url_of(video->beside);
    if (!url) {
        return ENOMEM;
    }
    snprintf(crf, sizeof(crf), "%g", options->crf >= 0 ? options->crf : encoder->crf);
    snprintf(threads, sizeof(threads), "%d", options->threads); /* 0: as many as it likes */
    struct words words = {.count = 0};
    add_words(&words, input);
    add_words(&words, (const char *const[]){"-c:v", encoder->name, "-crf", crf, "-threads", threads, NULL});
    add_words(&words, encoder->settings);
    add_words(&words, tags);
    if (!strcmp(container, "mp4")) {
        add_words(&words, front);
    }
    add_words(&words, (const char *const[]){"-f", container, url, NULL});
    int error = process_start(&video->encoder, words.list, PROCESS_FED);
    free(url);
    return error;
}

/* Makes the file that the video is written to, beside its place; a .y4m may also go into a device or a named pipe. 0 or an errno. */
static int open_file(struct video *video)
{
    struct stat status;
    bool in_place = stat(video->path, &status) == 0 && !S_ISREG(status.st_mode);
    size_t size = strlen(video->path) + 32;
    video->beside = in_place ? NULL : malloc(size);
    if (!in_place && !video->beside) {
        return ENOMEM;
    }
    if (!in_place) {
        snprintf(video->beside, size, "%s.tmp-%ld", video->path, (long)getpid());
    }
    video->file = fopen(in_place ? video->path : video->beside, in_place ? "wb" : "wbx");
    return video->file ? 0 : errno;
}

static bool fail(const struct video *video, struct mns_message *message, int error)
{
    const char *name = strcmp(video->path, "-") != 0 ? video->path : "standard output";
    snprintf(message->text, sizeof(message->text), "%.500s: cannot be written: %s", name, strerror(error));
    return false;
}

static void free_video(struct video *video)
{
    free(video->beside);
    free(video->planes);
    free(video);
}

static void discard(const struct video *video)
{
    if (video->beside) {
        remove(video->beside);
    }
}

/* Bytes on their way: 0 or an errno. */
static int put(struct video *video, const void *data, size_t size)
{
    if (video->encoder) {
        return process_write(video->encoder, data, size);
    }
    if (!video->file) {
        return program_output(data, size);
    }
    errno = 0;
    return fwrite(data, 1, size, video->file) == size ? 0 : errno ? errno : EIO;
}

/* Opens all there is to open. */
static bool set_up(struct video *video, const struct encoder *encoder, const struct options *options, struct mns_message *message)
{
    int error = strcmp(video->path, "-") != 0 ? open_file(video) : 0;
    if (!error && encoder && !video->beside) {
        snprintf(message->text, sizeof(message->text), "%.500s: is no plain file; the encoder needs one (a .y4m goes anywhere)",
                 video->path);
        return false;
    }
    if (!error && encoder) {
        fclose(video->file); /* the encoder opens it again: the name is ours now */
        video->file = NULL;
        error = start_encoder(video, encoder, options);
    }
    if (!error) {
        char header[160];
        snprintf(header, sizeof(header), "YUV4MPEG2 W%d H%d F%d:%d Ip A1:1 C420mpeg2 XYSCSS=420MPEG2 XCOLORRANGE=LIMITED\n", video->width,
                 video->height, options->fps[0], options->fps[1]);
        error = put(video, header, strlen(header));
    }
    return !error || fail(video, message, error);
}

struct video *video_open(const char *path, const struct encoder *encoder, const struct options *options, struct mns_message *message)
{
    struct video *video = calloc(1, sizeof(*video));
    if (!video) {
        snprintf(message->text, sizeof(message->text), "%.500s: out of memory", path);
        return NULL;
    }
    int even = encoder ? 1 : 0; /* encoders want even sides */
    *video = (struct video){
        .path = path, .width = options->width + (options->width & even), .height = options->height + (options->height & even)};
    video->bytes = yuv_bytes(video->width, video->height);
    video->planes = malloc(video->bytes);
    bool good = video->planes ? set_up(video, encoder, options, message) : fail(video, message, ENOMEM);
    if (good) {
        return video;
    }
    struct process_end end;
    if (video->encoder) {
        process_finish(video->encoder, &end);
    }
    if (video->file) {
        fclose(video->file);
    }
    discard(video);
    free_video(video);
    return NULL;
}

/* ---- pictures ---- */

/* Ends the encoder; false: message has its own words on why it could not go on. */
static bool end_encoder(struct video *video, struct mns_message *message)
{
    struct process_end end;
    process_finish(video->encoder, &end);
    video->encoder = NULL;
    if (!end.good) {
        snprintf(message->text, sizeof(message->text), "%.400s: the encoder ffmpeg failed: %s", video->path, end.why);
    }
    return end.good;
}

bool video_add(struct video *video, const struct mns_image *image, struct mns_message *message)
{
    static const char head[] = "FRAME\n";
    yuv_from_rgb(image, video->width, video->height, video->planes);
    int error = put(video, head, sizeof(head) - 1);
    error = error ? error : put(video, video->planes, video->bytes);
    if (!error) {
        video->pictures++;
        return true;
    }
    video->failed = true;
    return (error == EPIPE && video->encoder && !end_encoder(video, message)) ? false : fail(video, message, error);
}

/* "out.part.mp4" for "out.mp4"; NULL: out of memory. */
static char *part_of(const char *path)
{
    const char *dot = strrchr(path, '.');
    size_t before = dot ? (size_t)(dot - path) : strlen(path), size = strlen(path) + 6;
    char *part = malloc(size);
    if (part) {
        snprintf(part, size, "%.*s.part%s", (int)before, path, path + before);
    }
    return part;
}

/* Puts the file that is done in its place, or beside it where pictures are missing: 0 or an errno. */
static int place(const struct video *video, bool whole, struct mns_message *message)
{
    char *part = whole ? NULL : part_of(video->path);
    if (!whole && !part) {
        return ENOMEM;
    }
    int error = rename(video->beside, whole ? video->path : part) == 0 ? 0 : errno;
    if (!whole && !error) {
        snprintf(message->text, sizeof(message->text), "%.400s: the %zu pictures until here are kept in %.400s", video->path,
                 video->pictures, part);
    }
    free(part);
    return error;
}

/* Lines of what a child prints, but for those that begin with #. */
static size_t count_lines(struct process *process)
{
    char text[4096], before = '\n';
    size_t lines = 0, got;
    do {
        got = process_read(process, text, sizeof(text));
        for (size_t i = 0; i < got; before = text[i++]) {
            lines += before == '\n' && text[i] != '#';
        }
    } while (got == sizeof(text));
    return lines;
}

/* Reads the file back, undecoded, and counts its pictures: ffmpeg is known to say that all is well when the disk was full. */
static bool check_file(const struct video *video, struct mns_message *message)
{
    char *url = url_of(video->beside);
    if (!url) {
        return fail(video, message, ENOMEM);
    }
    const char *const arguments[] = {"ffmpeg", "-hide_banner", "-loglevel", "error", "-nostdin", "-i", url, "-map",
                                     "0:v",    "-c",           "copy",      "-f",    "framecrc", "-",  NULL};
    struct process *process;
    struct process_end end;
    int error = process_start(&process, arguments, PROCESS_READ);
    free(url);
    if (error) {
        return fail(video, message, error);
    }
    size_t pictures = count_lines(process);
    process_finish(process, &end);
    if (pictures != video->pictures) {
        snprintf(message->text, sizeof(message->text), "%.400s: the encoder ffmpeg wrote %zu of %zu pictures; is the disk full?",
                 video->path, pictures, video->pictures);
    }
    return pictures == video->pictures;
}

bool video_close(struct video *video, bool whole, struct mns_message *message)
{
    bool good = !video->failed;
    message->text[0] = '\0';
    if (video->encoder) {
        good = end_encoder(video, message) && good && (video->pictures == 0 || check_file(video, message));
    }
    if (video->file) {
        errno = 0;
        if (fclose(video->file) != 0 && good) {
            good = fail(video, message, errno ? errno : EIO);
        }
    }
    if (!good || video->pictures == 0) {
        discard(video);
    } else if (video->beside) {
        int error = place(video, whole, message);
        good = !error || fail(video, message, error);
        if (error) {
            discard(video);
        }
    }
    free_video(video);
    return good;
}
