"""`sim-plant serve`: a line in real or stepped time behind Modbus or on a CAN bus."""

from __future__ import annotations

import argparse
import contextlib
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from aff_runtime.base.arguments import speed_m_s
from aff_runtime.base.errors import PlantError
from sim_plant.base.shipped import shipped
from sim_plant.cli.output import say

if TYPE_CHECKING:
    from sim_plant.servers.serve import ServeOptions

DEFAULT_MAP = shipped("plc/gateway_block.yaml")

Subparsers = argparse._SubParsersAction  # noqa: SLF001 (argparse names it nowhere else)


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the subcommand."""
    parser = subparsers.add_parser(
        "serve", help="serve a line on Modbus (TCP, UDP) or CAN, in real or stepped time"
    )
    parser.add_argument(
        "line",
        type=Path,
        metavar="LINE.yaml",
        help="the line; where there is none of that name it says where the shipped ones lie",
    )
    parser.add_argument(
        "--modbus",
        default="127.0.0.1:5020",
        metavar="HOST:PORT",
        help="where to listen (default 127.0.0.1:5020)",
    )
    parser.add_argument("--udp", action="store_true", help="listen on UDP instead of TCP")
    parser.add_argument("--can", choices=("dbc", "canopen"), help="serve on CAN instead of Modbus")
    parser.add_argument(
        "--can-interface",
        default="frame_socket",
        metavar="NAME",
        help="frame_socket (unix), slcan_pty (serial line), socketcan, udp_multicast",
    )
    parser.add_argument(
        "--channel", default="", metavar="NAME", help="can0, or path of the socket"
    )
    parser.add_argument("--can-map", type=Path, metavar="MAP.yaml", help="the PLC's signals")
    parser.add_argument(
        "--plc",
        type=Path,
        default=DEFAULT_MAP,
        metavar="MAP.yaml",
        help="the PLC's words (default %(default)s)",
    )
    parser.add_argument(
        "--plc-code",
        type=Path,
        metavar="LIB.so",
        help="a library of your own in the place of the simulated PLC's program: aff_plc.h, "
        "docs/tester/recipes.md#plc-code-of-your-own",
    )
    parser.add_argument(
        "--speed-m-s",
        type=speed_m_s,
        metavar="SPEED",
        help="line speed: m/s, or with a unit such as '200 FPM' (default: the declaration's)",
    )
    parser.add_argument("--seed", type=int, default=0, help="of every random number (default 0)")
    parser.add_argument(
        "--record", type=Path, metavar="FILE.csv.gz", help="write the true signals of the line"
    )
    parser.add_argument("--control", type=Path, metavar="PATH", help="control socket to create")
    parser.add_argument(
        "--fault",
        action="append",
        default=[],
        metavar="SPEC",
        help="NAME[=ARG][@START][:DURATION] in s, for example freeze@10:5; may be repeated; "
        "an unknown name lists all",
    )
    parser.add_argument("--no-fc23", action="store_true", help="refuse function 23")
    parser.add_argument("--no-realtime", action="store_true", help="do not ask for SCHED_FIFO")
    parser.add_argument(
        "--stepped",
        action="store_true",
        help="virtual time: it stands until `sim-plant tell PATH step N`; needs --control PATH",
    )
    parser.add_argument("--duration", type=float, metavar="S", help="stop after S seconds")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Serve until a signal or the duration."""
    options = read_options(arguments)
    from sim_plant.base import jit  # noqa: PLC0415 (loads the compiler: only when used)
    from sim_plant.line import open_line  # noqa: PLC0415 (compiles the kernel: only when used)
    from sim_plant.servers.map_file import load_plc_map  # noqa: PLC0415
    from sim_plant.servers.serve import serve  # noqa: PLC0415

    plc_map = load_plc_map(arguments.plc)
    if jit.nothing_kept():
        print(
            f"opening {arguments.line}: the first start compiles the line's model, "
            "which takes some ten seconds",
            file=sys.stderr,
            flush=True,
        )
    line = open_line(arguments.line, seed=arguments.seed, speed_m_s=arguments.speed_m_s)
    serve(line, plc_map, options, _say)
    return 0


def _say(text: str) -> None:
    with contextlib.suppress(BrokenPipeError):  # a line whose log nobody reads goes on
        say(text)


def read_options(arguments: argparse.Namespace) -> ServeOptions:
    """Return the service's options.

    Raises
    ------
    PlantError
        An address, a fault or the duration is misspelt.
    """
    from sim_plant.servers.faults import parse_fault  # noqa: PLC0415
    from sim_plant.servers.serve import ServeOptions  # noqa: PLC0415

    host, _, port = arguments.modbus.rpartition(":")
    if not host or not port.isdecimal() or int(port) > 65535:
        raise PlantError(
            f"--modbus {arguments.modbus}: write HOST:PORT, for example 127.0.0.1:5020"
        )
    if arguments.can and arguments.udp:
        raise PlantError("--udp: it is a way of Modbus; leave --can out")
    if arguments.can and not arguments.channel:
        raise PlantError("--can: write --channel too (can0, or the path of the socket)")
    duration_s = arguments.duration
    if duration_s is not None and not (math.isfinite(duration_s) and duration_s > 0.0):
        raise PlantError(f"--duration {duration_s}: write seconds greater than 0")
    if arguments.stepped and arguments.control is None:
        raise PlantError(
            "--stepped: write --control PATH too; time stands until `sim-plant tell PATH step N`"
        )
    return ServeOptions(
        host=host,
        port=int(port),
        udp=arguments.udp,
        can=arguments.can or "",
        can_interface=arguments.can_interface,
        can_channel=arguments.channel,
        can_map=arguments.can_map or DEFAULT_MAP.with_name(f"can_{arguments.can}.yaml"),
        plc_code=arguments.plc_code,
        faults=tuple(parse_fault(text) for text in arguments.fault),
        allow_fc23=not arguments.no_fc23,
        record=arguments.record,
        control=arguments.control,
        duration_s=duration_s,
        realtime=not arguments.no_realtime,
        stepped=arguments.stepped,
    )
