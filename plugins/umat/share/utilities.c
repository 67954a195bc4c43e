/* The utility routines that UMATs and VUMATs call, written for lahar from their published descriptions. `lahar plugin umat-build` links
 * them into the user's library. They are called from Fortran: everything is passed by address, names end with an underscore, and
 * lengths of texts follow the last argument.
 *
 * XIT ends the call of the UMAT, not the process: it jumps back to `lahar_umat_guard`, and the point counts as failed.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* --- between the adapter and this library --- */

static __thread void **way_back; /* of the compiler's own setjmp, which saves the least */
static void (*log_text)(int level, const char *text);

void lahar_umat_set_log(void (*log)(int, const char *)) { log_text = log; }

/* Runs body(data). Returns 0, or 1 if XIT or the like ended it. */
int lahar_umat_guard(void (*body)(void *), void *data)
{
    void *here[5];
    void **volatile outer = way_back;
    way_back = here;
    if (__builtin_setjmp(here)) {
        way_back = outer;
        return 1;
    }
    body(data);
    way_back = outer;
    return 0;
}

static void leave(void)
{
    if (way_back) {
        __builtin_longjmp(way_back, 1);
    }
}

/* --- end of the analysis --- */

void xit_(void) { leave(); }

void xplb_exit_(void) { leave(); }

/* --- messages --- */

static void append(char *text, size_t room, const char *more, size_t length)
{
    size_t used = strlen(text);
    if (length > room - 1 - used) {
        length = room - 1 - used;
    }
    memcpy(text + used, more, length);
    text[used + length] = 0;
}

/* Replaces %I, %R and %S by the next number or text. */
static void message(int lop, const char *form, size_t length, const int *intv, const double *realv, const char *charv, size_t text_length)
{
    char out[1024] = "", number[40];
    while (length > 0 && form[length - 1] == ' ') {
        length--;
    }
    for (size_t i = 0; i < length; i++) {
        char kind = form[i] == '%' && i + 1 < length ? form[i + 1] : 0;
        if (kind == 'I' || kind == 'i') {
            snprintf(number, sizeof number, "%d", *intv++);
            append(out, sizeof out, number, strlen(number));
        } else if (kind == 'R' || kind == 'r') {
            snprintf(number, sizeof number, "%.10g", *realv++);
            append(out, sizeof out, number, strlen(number));
        } else if (kind == 'S' || kind == 's') {
            size_t used = text_length;
            while (used > 0 && charv[used - 1] == ' ') {
                used--;
            }
            append(out, sizeof out, charv, used);
            charv += text_length;
        } else {
            append(out, sizeof out, form + i, 1);
            continue;
        }
        i++;
    }
    if (log_text) {
        log_text(lop > 0 ? 2 : lop == -1 ? 1 : 0, out); /* information, warning, error */
    }
    if (lop == -3) {
        leave();
    }
}

/* LOP 1: information, -1: warning, -2: error, -3: error that ends the call. */
void stdb_abqerr_(const int *lop, const char *form, const int *intv, const double *realv, const char *charv, size_t length,
                  size_t text_length)
{
    message(*lop, form, length, intv, realv, charv, text_length);
}

void xplb_abqerr_(const int *lop, const char *form, const int *intv, const double *realv, const char *charv, size_t length,
                  size_t text_length)
{
    message(*lop, form, length, intv, realv, charv, text_length);
}

/* --- names --- */

static void give(char *to, int *used, size_t room, const char *text)
{
    size_t length = strlen(text) < room ? strlen(text) : room;
    memset(to, ' ', room);
    memcpy(to, text, length);
    *used = (int)length;
}

void getjobname_(char *name, int *length, size_t room) { give(name, length, room, "lahar"); }

void vgetjobname_(char *name, int *length, size_t room) { give(name, length, room, "lahar"); }

/* The folder in which the program runs. */
void getoutdir_(char *name, int *length, size_t room)
{
    char folder[4096];
    give(name, length, room, getcwd(folder, sizeof folder) ? folder : ".");
}

void vgetoutdir_(char *name, int *length, size_t room) { getoutdir_(name, length, room); }

/* --- tensors --- */

/* Places of the shear components: 12, 13, 23 in a UMAT, 12, 23, 31 in a VUMAT. */
static const int STANDARD[3][2] = {{0, 1}, {0, 2}, {1, 2}};
static const int EXPLICIT[3][2] = {{0, 1}, {1, 2}, {2, 0}};

static void unpack(double a[3][3], const double *s, int ndi, int nshr, double shear, const int place[3][2])
{
    memset(a, 0, 9 * sizeof(double));
    for (int i = 0; i < ndi && i < 3; i++) {
        a[i][i] = s[i];
    }
    for (int i = 0; i < nshr && i < 3; i++) {
        a[place[i][0]][place[i][1]] = a[place[i][1]][place[i][0]] = shear * s[ndi + i];
    }
}

/* Eigenvalues of a symmetric matrix onto its diagonal and unit eigenvectors into the columns of v, by cyclic Jacobi rotations
 * (Golub, Van Loan: Matrix Computations, section 8.5). */
static void eigen(double a[3][3], double v[3][3])
{
    for (int i = 0; i < 9; i++) {
        v[i / 3][i % 3] = i % 4 == 0;
    }
    for (int sweep = 0; sweep < 30; sweep++) {
        double off = fabs(a[0][1]) + fabs(a[0][2]) + fabs(a[1][2]);
        if (!(off > 0)) {
            return;
        }
        for (int p = 0; p < 2; p++) {
            for (int q = p + 1; q < 3; q++) {
                if (a[p][q] == 0) {
                    continue;
                }
                double tau = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                double t = (tau >= 0 ? 1 : -1) / (fabs(tau) + sqrt(1 + tau * tau));
                double c = 1 / sqrt(1 + t * t), s = t * c;
                for (int k = 0; k < 3; k++) {
                    double x = a[k][p], y = a[k][q];
                    a[k][p] = c * x - s * y;
                    a[k][q] = s * x + c * y;
                }
                for (int k = 0; k < 3; k++) {
                    double x = a[p][k], y = a[q][k];
                    a[p][k] = c * x - s * y;
                    a[q][k] = s * x + c * y;
                    x = v[k][p], y = v[k][q];
                    v[k][p] = c * x - s * y;
                    v[k][q] = s * x + c * y;
                }
                a[p][q] = a[q][p] = 0;
            }
        }
    }
}

/* tr(s) / 3 and sqrt(3/2 S:S) with the deviator S. */
void sinv_(const double *stress, double *sinv1, double *sinv2, const int *ndi, const int *nshr)
{
    double a[3][3], sum = 0;
    unpack(a, stress, *ndi, *nshr, 1, STANDARD);
    double mean = (a[0][0] + a[1][1] + a[2][2]) / 3;
    for (int i = 0; i < 9; i++) {
        double deviator = a[i / 3][i % 3] - (i % 4 == 0 ? mean : 0);
        sum += deviator * deviator;
    }
    *sinv1 = mean;
    *sinv2 = sqrt(1.5 * sum);
}

/* Principal values; lstr 1: stress, 2: strain with engineering shears. */
void sprinc_(const double *s, double *ps, const int *lstr, const int *ndi, const int *nshr)
{
    double a[3][3], v[3][3];
    unpack(a, s, *ndi, *nshr, *lstr == 2 ? 0.5 : 1, STANDARD);
    eigen(a, v);
    for (int i = 0; i < 3; i++) {
        ps[i] = a[i][i];
    }
}

/* The same, and an(k, i), component i of the direction of ps(k). */
void sprind_(const double *s, double *ps, double *an, const int *lstr, const int *ndi, const int *nshr)
{
    double a[3][3], v[3][3];
    unpack(a, s, *ndi, *nshr, *lstr == 2 ? 0.5 : 1, STANDARD);
    eigen(a, v);
    for (int k = 0; k < 3; k++) {
        ps[k] = a[k][k];
        for (int i = 0; i < 3; i++) {
            an[k + 3 * i] = v[i][k];
        }
    }
}

/* r s r^T; lstr as above. */
void rotsig_(const double *s, const double *r, double *sprime, const int *lstr, const int *ndi, const int *nshr)
{
    double a[3][3], b[3][3], shear = *lstr == 2 ? 0.5 : 1;
    unpack(a, s, *ndi, *nshr, shear, STANDARD);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            b[i][j] = 0;
            for (int k = 0; k < 3; k++) {
                for (int l = 0; l < 3; l++) {
                    b[i][j] += r[i + 3 * k] * a[k][l] * r[j + 3 * l];
                }
            }
        }
    }
    for (int i = 0; i < *ndi; i++) {
        sprime[i] = b[i][i];
    }
    for (int i = 0; i < *nshr; i++) {
        sprime[*ndi + i] = b[STANDARD[i][0]][STANDARD[i][1]] / shear;
    }
}

/* Of the tensors of a block, each component for all points after the other, as VUMATs store them. */
static void block(const double *s, double *eig, double *vec, int n, int ndir, int nshr)
{
    for (int point = 0; point < n; point++) {
        double one[6] = {0}, a[3][3], v[3][3];
        for (int c = 0; c < ndir + nshr && c < 6; c++) {
            one[c] = s[point + n * c];
        }
        unpack(a, one, ndir, nshr, 1, EXPLICIT);
        eigen(a, v);
        for (int k = 0; k < 3; k++) {
            eig[point + n * k] = a[k][k];
            for (int i = 0; vec && i < 3; i++) {
                vec[point + n * (i + 3 * k)] = v[i][k];
            }
        }
    }
}

void vsprinc_(const int *nblock, const double *s, double *eig, const int *ndir, const int *nshr)
{
    block(s, eig, NULL, *nblock, *ndir, *nshr);
}

/* eig(point, k), and vec(point, i, k), component i of direction k. */
void vsprind_(const int *nblock, const double *s, double *eig, double *vec, const int *ndir, const int *nshr)
{
    block(s, eig, vec, *nblock, *ndir, *nshr);
}
