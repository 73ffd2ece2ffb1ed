/* The gateway block in Structured Text as the PLC of a simulated line, for the shipped map of words:
 *
 *   strucpp AFF_GATEWAY.st -o gateway.cpp --no-default-libs
 *   g++ -std=c++17 -shared -fPIC -I STRUCPP/src/runtime/include -I . aff_plc_strucpp.cpp -o plc.so
 *   sim-plant serve LINE.yaml --plc-code ./plc.so
 *
 * Another block or compiler needs another file of this kind: words in, one call, words out.
 */
#include "gateway.cpp"

#include "aff_plc.h"

static strucpp::AFF_GATEWAY *block;

extern "C" void aff_plc_begin(void)
{
    delete block;
    block = new strucpp::AFF_GATEWAY();
}

extern "C" int aff_plc_scan(struct aff_plc_scan *scan)
{
    if (scan->written_count < 10 || scan->shown_count < 18 || scan->corrections_count != 2)
        return -1; /* another map than the shipped one */

    const int needs =
        AFF_LINE_RUN | AFF_ENABLE_REQUEST | AFF_WEB_INTACT | AFF_TENSION_VALID | AFF_ESTOP_OK;
    const uint16_t *in = scan->written; /* from word 100 */
    uint16_t *out = scan->shown;        /* from word 0 */

    block->AFFHEARTBEAT = in[0];
    block->AFFSTATE = in[1];
    block->WORD1 = (int16_t)in[3];
    block->COPY1 = in[4];
    block->WORD2 = (int16_t)in[8];
    block->COPY2 = in[9];
    block->WANTED = (scan->status & AFF_ENABLE_REQUEST) != 0;
    block->PERMISSIVES = (scan->status & needs) == needs;
    block->RESET = (scan->status & AFF_RESET_EDGE) != 0;
    block->SCANTIME = (float)scan->since_s;
    (*block)();

    out[0] = (uint16_t)block->PLCHEARTBEAT;
    if (!(bool)block->ENABLEREQUEST)
        out[1] &= (uint16_t)~AFF_ENABLE_REQUEST;
    out[15] = (uint16_t)block->AFFECHO;
    out[16] = (uint16_t)(int16_t)block->APPLIED1;
    out[17] = (uint16_t)(int16_t)block->APPLIED2;
    scan->corrections[0] = (double)(float)block->CORRECTION1 * 1e-5; /* counts to m/s */
    scan->corrections[1] = (double)(float)block->CORRECTION2 * 1e-5;
    return (int16_t)block->REFUSAL;
}
