/* A Modbus server made of libmodbus alone: an independent peer for the runtime's transports.
 *
 *     libmodbus_server tcp            listens on a free port of loopback
 *     libmodbus_server rtu PATH       answers as device 1 on a serial line
 *
 * 200 holding registers, the first of which counts requests; register n starts as 3 n. Prints
 * "ready PORT", then after each request that wrote anything the ten registers from 100 on.
 */
#include <arpa/inet.h>
#include <errno.h>
#include <modbus/modbus.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static int serve(modbus_t *context, modbus_mapping_t *map)
{
    uint8_t request[MODBUS_TCP_MAX_ADU_LENGTH];
    for (;;) {
        int length = modbus_receive(context, request);
        if (length < 0 && errno != EMBBADCRC) {
            return 0;
        }
        if (length <= 0) {
            continue;
        }
        int function = request[modbus_get_header_length(context)];
        map->tab_registers[0]++;
        if (modbus_reply(context, request, length, map) < 0) {
            return 0;
        }
        if (function == 16 || function == 23) {
            for (int i = 100; i < 110; i++) {
                printf("%u%c", map->tab_registers[i], i == 109 ? '\n' : ' ');
            }
        }
    }
}

int main(int count, char **words)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    modbus_mapping_t *map = modbus_mapping_new(0, 0, 200, 0);
    if (map == NULL || count < 2) {
        return 2;
    }
    for (int i = 1; i < 200; i++) {
        map->tab_registers[i] = 3 * i;
    }
    if (strcmp(words[1], "rtu") == 0 && count == 3) {
        modbus_t *line = modbus_new_rtu(words[2], 115200, 'N', 8, 1);
        if (line == NULL || modbus_set_slave(line, 1) < 0 || modbus_connect(line) < 0) {
            return 3;
        }
        printf("ready 0\n");
        return serve(line, map);
    }
    modbus_t *context = modbus_new_tcp("127.0.0.1", 0);
    int listener = context == NULL ? -1 : modbus_tcp_listen(context, 1);
    struct sockaddr_in address;
    socklen_t size = sizeof address;
    if (listener < 0 || getsockname(listener, (struct sockaddr *) &address, &size) < 0) {
        return 3;
    }
    printf("ready %d\n", ntohs(address.sin_port));
    while (modbus_tcp_accept(context, &listener) >= 0) {
        serve(context, map);
        modbus_close(context);
    }
    return 0;
}
