/* Forms of the tables that come with a line. */

#include <stdio.h>
#include <string.h>

#define PI 3.141592653589793
#define TAU (2.0 * PI)

/* how an output is read from a row: without noise from another column; an angle counts from its
   own at the start (`zero`: bodies, then encoders of drives), and an eccentric encoder reads
   theta + e sin(theta + a) */
typedef struct {
    int64_t column, exact_column, zero;
    double scale, lsb, eccentricity, eccentricity_angle_rad;
} channel;

typedef enum { REAL, INTEGER, TRUTH } number_kind;
typedef enum { SET_NEVER, SET_BEFORE, SET_ALWAYS } set_when;
enum { INSTANTIATED, INITIALIZING, STEPPING, TERMINATED };

/* what an importer sets and reads: `at` counts bytes in line_memory */
typedef struct {
    const char *name;
    number_kind kind;
    set_when when;
    size_t at;
    double low, high;
} variable;
