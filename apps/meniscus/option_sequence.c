/* option_sequence.c: options of sequences and videos. */
#include "option_sequence.h"

#include "option_values.h"

#include <math.h>
#include <string.h>

/* A:B:STEP, any part may be left out. A alone is that one frame. */
bool option_set_frames(struct options *options, const char *value, struct mns_message *message)
{
    static const long long most = 1LL << 53;
    const char *at = value;
    options->has_first = options->has_last = false;
    options->step = 1;
    bool good = true;
    if (*at && *at != ':') {
        good = option_whole(at, -most, most, &options->first, &at);
        options->has_first = true;
    }
    if (good && !*at && options->has_first) {
        options->last = options->first;
        return options->has_last = true;
    }
    good = good && *at++ == ':';
    if (good && *at && *at != ':') {
        good = option_whole(at, -most, most, &options->last, &at);
        options->has_last = true;
    }
    if (good && *at == ':') {
        good = !at[1] || option_count(at + 1, 1, most, &options->step);
    } else {
        good = good && !*at;
    }
    return good || option_refuse(message, "'%s' must be A:B:STEP in frame numbers, such as 10:20, 10:, :20 or ::2", value);
}

bool option_set_resume(struct options *options, const char *value, struct mns_message *message)
{
    (void)value;
    (void)message;
    return options->resume = true;
}

bool option_set_keep_going(struct options *options, const char *value, struct mns_message *message)
{
    (void)value;
    (void)message;
    return options->keep_going = true;
}

bool option_set_retime(struct options *options, const char *value, struct mns_message *message)
{
    long long count;
    if (!option_count(value, 1, 1000, &count)) {
        return option_refuse(message, "'%s' must be a whole number of pictures per frame, 1 to 1000", value);
    }
    options->retime = (int)count;
    return true;
}

bool option_set_shutter(struct options *options, const char *value, struct mns_message *message)
{
    return (option_numbers(value, 1, &options->shutter) && options->shutter >= 0 && options->shutter <= 1) ||
           option_refuse(message, "'%s' must be the part of the time between pictures that the shutter is open, 0 to 1", value);
}

bool option_set_shutter_samples(struct options *options, const char *value, struct mns_message *message)
{
    long long count;
    if (!option_count(value, 2, 256, &count)) {
        return option_refuse(message, "'%s' must be a whole number from 2 to 256", value);
    }
    options->shutter_samples = (int)count;
    return true;
}

/* N, N/D, or a decimal; 23.976 and the like are N * 1000 / 1001, as television means them. */
bool option_set_fps(struct options *options, const char *value, struct mns_message *message)
{
    long long numerator, denominator = 1;
    const char *end;
    double number;
    bool good = option_whole(value, 1, 1000000, &numerator, &end);
    if (good && *end == '/') {
        good = option_count(end + 1, 1, 1000000, &denominator);
    } else if (option_numbers(value, 1, &number) && number >= 0.001 && number <= 1000) {
        double television = ceil(number) * 1000 / 1001;
        bool near = number != ceil(number) && fabs(number - television) < 0.005;
        numerator = llround(near ? ceil(number) * 1000 : number * 1000);
        denominator = near ? 1001 : 1000;
        good = true;
    } else {
        good = false;
    }
    if (!good) {
        return option_refuse(message, "'%s' must be pictures per second, such as 30, 23.976 or 30000/1001", value);
    }
    for (int divisor = 2; divisor <= 5; divisor += 3) { /* 30000/1000 is 30/1 */
        while (numerator % divisor == 0 && denominator % divisor == 0) {
            numerator /= divisor;
            denominator /= divisor;
        }
    }
    options->fps[0] = (int)numerator;
    options->fps[1] = (int)denominator;
    return true;
}

bool option_set_crf(struct options *options, const char *value, struct mns_message *message)
{
    return (option_numbers(value, 1, &options->crf) && options->crf >= 0 && options->crf <= 63) ||
           option_refuse(message, "'%s' must be a number from 0 (best) to 51 (h264) or 63 (vp9, av1)", value);
}

bool option_set_codec(struct options *options, const char *value, struct mns_message *message)
{
    static const char *const names[] = {"auto", "h264", "vp9", "av1"};
    for (int i = 0; i < (int)(sizeof(names) / sizeof(names[0])); i++) {
        if (!strcmp(names[i], value)) {
            options->codec = (enum codec)i;
            return true;
        }
    }
    return option_refuse(message, "'%s' is none of auto, h264, vp9 and av1", value);
}
