/* One kinematics module of LinuxCNC as a program, with just enough of HAL around it.
 *
 *   cc -O2 -DRTAPI -DUSPACE -DKINS='"corexykins.c"' [-DSWITCHABLE] -I SRC/emc/kinematics -I SRC/rtapi -I SRC/hal
 *      -I SRC/emc/nml_intf -I SRC/libposemath linuxcnc_kins.c -lm
 *
 * SWITCHABLE: the module hands out its functions through switchkinsSetup (scarakins).
 *
 *   program forward|inverse FLAG [PIN ...] < numbers
 *
 * FLAG is the flag of the inverse kinematics, PIN the values of the module's HAL pins in the order in which it makes
 * them. A line of input is nine numbers, joints or x y z a b c u v w. A line of output is what the function returned,
 * the flag that the forward kinematics set, and nine numbers.
 *
 *   program time-forward|time-inverse FLAG [PIN ...] < numbers
 *
 * prints how many nanoseconds one call takes, in the fastest of several passes over the lines.
 */

#include KINS

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST_PINS = 16, NUMBERS = 9, PASSES = 50 };
static double pins[MOST_PINS];
static int pin_count;
static char **pin_values;

int hal_init(const char *name) { (void)name; return 1; }
int hal_ready(int id) { (void)id; return 0; }
int hal_exit(int id) { (void)id; return 0; }
void *hal_malloc(long int size) { return calloc(1, (size_t)size); }
void rtapi_print(const char *format, ...) { (void)format; }

int hal_pin_new_real(int id, hal_pdir_t direction, hal_real_t *pin, rtapi_real value,
                     const char *format, ...)
{
    (void)id, (void)direction, (void)format;
    if (pin_count == MOST_PINS)
        return -1;
    if (*pin_values)
        value = strtod(*pin_values++, NULL);
    pins[pin_count] = value;
    *pin = (hal_real_t)&pins[pin_count++];
    return 0;
}

#ifdef SWITCHABLE
/* What a switchable module names besides its own; nothing here uses it. */
#define UNUSED(kind)                                                                       \
    int kind##KinematicsSetup(const int id, const char *coordinates, kparms *parameters)  \
    { (void)id, (void)coordinates, (void)parameters; return -1; }                          \
    int kind##KinematicsForward(const double *joint, EmcPose *pose,                        \
                                const KINEMATICS_FORWARD_FLAGS *forward,                    \
                                KINEMATICS_INVERSE_FLAGS *inverse)                          \
    { (void)joint, (void)pose, (void)forward, (void)inverse; return -1; }                  \
    int kind##KinematicsInverse(const EmcPose *pose, double *joint,                        \
                                const KINEMATICS_INVERSE_FLAGS *inverse,                    \
                                KINEMATICS_FORWARD_FLAGS *forward)                          \
    { (void)joint, (void)pose, (void)forward, (void)inverse; return -1; }
UNUSED(identity)
UNUSED(userk)

static KF forward_of;
static KI inverse_of;

static int start(void)
{
    kparms parameters = {0};
    KS setup, other_setup;
    KF other_forward;
    KI other_inverse;
    if (switchkinsSetup(&parameters, &setup, &other_setup, &other_setup, &forward_of, &other_forward,
                        &other_forward, &inverse_of, &other_inverse, &other_inverse))
        return -1;
    return setup(1, parameters.required_coordinates, &parameters);
}
#else
#define forward_of kinematicsForward
#define inverse_of kinematicsInverse

static int start(void) { return rtapi_app_main(); }
#endif

static void to_pose(const double *v, EmcPose *pose)
{
    memset(pose, 0, sizeof *pose);
    pose->tran.x = v[0], pose->tran.y = v[1], pose->tran.z = v[2];
    pose->a = v[3], pose->b = v[4], pose->c = v[5];
    pose->u = v[6], pose->v = v[7], pose->w = v[8];
}

static void from_pose(const EmcPose *pose, double *v)
{
    v[0] = pose->tran.x, v[1] = pose->tran.y, v[2] = pose->tran.z;
    v[3] = pose->a, v[4] = pose->b, v[5] = pose->c;
    v[6] = pose->u, v[7] = pose->v, v[8] = pose->w;
}

static int read_numbers(double *v)
{
    for (int i = 0; i < NUMBERS; i++)
        if (scanf("%lf", &v[i]) != 1)
            return 0;
    return 1;
}

static void convert(int forward, KINEMATICS_INVERSE_FLAGS flag)
{
    double in[NUMBERS];
    while (read_numbers(in)) {
        double out[NUMBERS] = {0};
        EmcPose pose;
        KINEMATICS_FORWARD_FLAGS unused = 0;
        KINEMATICS_INVERSE_FLAGS set = flag;
        int result;
        to_pose(in, &pose);
        if (forward) {
            memset(&pose, 0, sizeof pose);
            result = forward_of(in, &pose, &unused, &set);
            from_pose(&pose, out);
        } else {
            result = inverse_of(&pose, out, &set, &unused);
        }
        printf("%d %lu", result, set);
        for (int i = 0; i < NUMBERS; i++)
            printf(" %.17g", out[i]);
        printf("\n");
    }
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

/* All that LinuxCNC would use of the results is added up, so that none of it can be left out. */
static double pass(int forward, KINEMATICS_INVERSE_FLAGS flag, const double (*joints)[NUMBERS],
                   const EmcPose *poses, long count)
{
    double sum = 0.0;
    KINEMATICS_FORWARD_FLAGS unused = 0;
    for (long i = 0; i < count; i++) {
        if (forward) {
            EmcPose out;
            KINEMATICS_INVERSE_FLAGS set = flag;
            if (forward_of(joints[i], &out, &unused, &set) == 0)
                sum += out.tran.x + out.tran.y + out.tran.z + out.c;
        } else {
            double out[NUMBERS];
            if (inverse_of(&poses[i], out, &flag, &unused) == 0)
                sum += out[0] + out[1] + out[2] + out[3];
        }
    }
    return sum;
}

static int time_it(int forward, KINEMATICS_INVERSE_FLAGS flag)
{
    enum { MOST = 1 << 16 };
    static double joints[MOST][NUMBERS];
    static EmcPose poses[MOST];
    long count = 0;
    while (count < MOST && read_numbers(joints[count])) {
        to_pose(joints[count], &poses[count]);
        count++;
    }
    if (count == 0)
        return 1;
    /* A pass short enough to be left alone on a busy machine now and then. */
    long repeat = 1 + 20000 / count;
    double fastest = 1e300;
    volatile double sink = 0.0;
    for (int i = 0; i < PASSES; i++) {
        double begin = now();
        for (long j = 0; j < repeat; j++)
            sink += pass(forward, flag, (const double(*)[NUMBERS])joints, poses, count);
        double time = (now() - begin) / (double)(repeat * count);
        if (time < fastest)
            fastest = time;
    }
    printf("%.17g\n", fastest);
    return 0;
}

int main(int count, char **arguments)
{
    if (count < 3)
        return 2;
    const char *mode = arguments[1];
    KINEMATICS_INVERSE_FLAGS flag = strtoul(arguments[2], NULL, 10);
    pin_values = arguments + 3;
    if (start() < 0)
        return 1;
    if (strcmp(mode, "forward") == 0 || strcmp(mode, "inverse") == 0)
        convert(mode[0] == 'f', flag);
    else if (strcmp(mode, "time-forward") == 0 || strcmp(mode, "time-inverse") == 0)
        return time_it(mode[5] == 'f', flag);
    else
        return 2;
    return 0;
}
