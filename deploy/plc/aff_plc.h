/* PLC code of your own between the wire and a simulated line: sim-plant serve LINE --plc-code LIB.so
 *
 * The library has the two functions at the end. The wire (Modbus, CAN), its faults, the status bits
 * and the line are the simulation's, the words are those of the map (--plc MAP.yaml); between the
 * words that a client wrote and the correction that reaches the drives stands your code alone:
 * watchdog, limits, complements, permissives, ramp to zero, heartbeat and echo.
 *
 * What CAN carries is taken from the same words: what your code says is applied, and each channel whose
 * words it changes. A function that does not return for 2 s ends the plant.
 */
#ifndef AFF_PLC_H
#define AFF_PLC_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum aff_plc_status {
    AFF_LINE_RUN = 1,
    AFF_ENABLE_REQUEST = 2,
    AFF_REMOTE = 4,
    AFF_WEB_INTACT = 8,
    AFF_SPLICE_ACTIVE = 16,
    AFF_TENSION_VALID = 32,
    AFF_ESTOP_OK = 64,
    AFF_RESET_EDGE = 128
};

struct aff_plc_scan {
    double time_s;           /* of the plant at this scan, from 0 */
    double since_s;          /* since the scan before, also over a restart; of the first: since 0 */
    uint16_t status;         /* status bits of the machine, enum aff_plc_status */
    uint16_t roll_id;        /* one more with every splice */
    uint16_t measured_count; /* how many there are of each of the following */
    uint16_t written_count;
    uint16_t shown_count;
    uint16_t corrections_count;
    const double *measured;  /* SI: the channels of the map, in its order; NaN is none */
    const uint16_t *written; /* the map's write block, as clients left it */
    uint16_t *shown;         /* the map's read block, from this scan on. Comes with channels, status and
                                roll_id in place; heartbeat, echo and what is applied are 0 */
    double *corrections;     /* m/s: added to the speed reference of the map's actuators, in its order.
                                Comes as 0 */
};

/* Power up: before the first scan, and after the fault `restart`. */
void aff_plc_begin(void);

/* One scan. Returns 0 where the client's correction counts, else a number of yours that says why not. */
int aff_plc_scan(struct aff_plc_scan *scan);

#ifdef __cplusplus
}
#endif

#endif
