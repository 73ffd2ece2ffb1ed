"""From log rows of the kernel to the channels of a declaration."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array, LineArrays
from sim_plant.line.arrays.build import cell_sensors
from sim_plant.line.declared.declaration import (
    CarriagePosition,
    Declaration,
    LoadCell,
    RollAngle,
    RollRadius,
)
from sim_plant.line.equations.layout import Layout
from sim_plant.line.equations.log_layout import LogLayout, log_layout


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel:
    """How one recorded channel is read from a log row."""

    name: str
    column: int  # measured value in the log row
    true_column: int
    exact_column: int  # measured value of a noise-free run
    scale: float = 1.0
    lsb: float = 0.0  # applied here for angles, radii; the kernel quantises forces and speeds
    theta_body: int = -1  # the body whose angle this is, or -1
    zero: int = -1  # of the angle as measured: place in the angles at the start of the record
    eccentricity: float = 0.0  # of the encoder: the angle reads theta + e sin(theta + a)
    eccentricity_angle_rad: float = 0.0


def channels_of(declaration: Declaration, lay: Layout, p: LineArrays) -> list[Channel]:
    """Return how each declared sensor is read from a log row.

    Raises
    ------
    PlantError
        When a speed is declared for a roller without a drive.
    """
    log = log_layout(p.cells.size, p.drives.size, lay.n, p.carriages.size)
    cell_of = {s.channel: c for c, s in enumerate(cell_sensors(declaration))}
    found = []
    for sensor in declaration.sensors:
        name, body = sensor.channel, declaration.body(sensor.roller)
        where = np.flatnonzero(p.drives["body"] == body)
        if isinstance(sensor, LoadCell):
            cell = cell_of[name]
            true = log.true_N + cell
            found.append(_channel(name, log.measured_N + cell, true=true, exact=true))
        elif isinstance(sensor, CarriagePosition):
            at = log.travel_m + int(p.bodies["carriage"][body])
            found.append(_channel(name, at, lsb=sensor.lsb_m))
        elif isinstance(sensor, RollRadius):
            at = log.radius_m + (0 if body == 0 else 1)
            believed = float(p.drives["radius_ratio"][where[0]]) if where.size else 1.0
            found.append(_channel(name, at, lsb=sensor.lsb_m, scale=believed))
        elif isinstance(sensor, RollAngle):
            found.append(_angle(name, log, body, sensor.lsb_rad, p))
        elif where.size == 0:
            raise PlantError(f"sensors.{name}: {sensor.roller} has no drive")
        else:
            drive, scale = int(where[0]), sensor.scale_radius_m or 1.0
            at = log.measured_rad_s + drive
            found.append(_channel(name, at, true=log.true_rad_s + drive, scale=scale))
    return found


def _channel(
    name: str,
    column: int,
    *,
    true: int | None = None,
    exact: int | None = None,
    scale: float = 1.0,
    lsb: float = 0.0,
) -> Channel:
    """Return a channel whose true and exact values stand where the measured one does, or apart."""
    return Channel(
        name=name,
        column=column,
        true_column=column if true is None else true,
        exact_column=column if exact is None else exact,
        scale=scale,
        lsb=lsb,
    )


def _angle(name: str, log: LogLayout, body: int, lsb_rad: float, p: LineArrays) -> Channel:
    """Return an angle: of a driven roller where its encoder is, on the motor, as its speed is."""
    at = true = log.theta_rad + body
    zero, offset, angle_rad = body, 0.0, 0.0
    for d in np.flatnonzero(p.drives["body"] == body):
        at, zero = log.encoder_rad + int(d), p.bodies.size + int(d)
        offset = float(p.drives["encoder_offset_ratio"][d])
        angle_rad = float(p.drives["encoder_angle_rad"][d])
    return Channel(
        name=name,
        column=at,
        true_column=true,
        exact_column=at,
        lsb=lsb_rad,
        theta_body=body,
        zero=zero,
        eccentricity=offset,
        eccentricity_angle_rad=angle_rad,
    )


def column_values(
    channel: Channel, rows: Array, theta0: Array, exact: bool
) -> tuple[Array, Array]:
    """Return measured and true values of one channel for log rows (samples, columns).

    ``theta0`` : angles of all bodies, then of the encoders of all drives, where the record starts.
    """
    measured = rows[:, channel.exact_column if exact else channel.column] * channel.scale
    true = rows[:, channel.true_column] * channel.scale
    if channel.theta_body >= 0:
        zero = float(theta0[channel.zero])
        turn = measured + channel.eccentricity_angle_rad
        measured = measured - zero
        if channel.eccentricity != 0.0:
            start = zero + channel.eccentricity_angle_rad
            measured = measured + channel.eccentricity * (np.sin(turn) - np.sin(start))
        true = true - float(theta0[channel.theta_body])
    if channel.lsb > 0.0 and not exact:
        measured = channel.lsb * np.floor(measured / channel.lsb + 0.5)
    return measured, true


def channel_value(
    channel: Channel, row: Sequence[float], theta0: Sequence[float], exact: bool
) -> tuple[float, float]:
    """Return measured and true value of one channel for one log row.

    The numbers of `column_values` to the last bit: arrays of one element cost ten times as much,
    and a plant that is stepped does this for every channel of every sample.
    """
    measured = row[channel.exact_column if exact else channel.column] * channel.scale
    true = row[channel.true_column] * channel.scale
    if channel.theta_body >= 0:
        zero = theta0[channel.zero]
        turn = measured + channel.eccentricity_angle_rad
        measured -= zero
        if channel.eccentricity != 0.0:
            start = np.sin(zero + channel.eccentricity_angle_rad)
            measured += channel.eccentricity * float(np.sin(turn) - start)
        true -= theta0[channel.theta_body]
    if channel.lsb > 0.0 and not exact:
        steps = measured / channel.lsb + 0.5
        measured = channel.lsb * (math.floor(steps) if math.isfinite(steps) else steps)
    return measured, true


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeasuredColumns:
    """Channels read from a log that has their columns only.

    Attributes
    ----------
    columns : of a whole log row, in the order in which the short log has them.
    channels : how each is read from a row of the short log.
    first : those columns of the row that the record starts with.
    theta0 : angles of all bodies, then of all encoders, there, rad.
    exact : of a noise-free run.
    """

    columns: tuple[int, ...]
    channels: tuple[Channel, ...]
    first: Array
    theta0: Array
    exact: bool

    @classmethod
    def of(
        cls, channels: Sequence[Channel], row: Array, theta0: Array, exact: bool
    ) -> MeasuredColumns:
        """Return the columns of some channels of a line whose last log row is ``row``."""
        pairs = [(c.exact_column if exact else c.column, c.true_column) for c in channels]
        columns = sorted({column for pair in pairs for column in pair})
        place = {column: at for at, column in enumerate(columns)}
        short = [
            replace(c, column=place[m], exact_column=place[m], true_column=place[t])
            for c, (m, t) in zip(channels, pairs, strict=True)
        ]
        first = row[columns].copy()
        return cls(
            columns=tuple(columns),
            channels=tuple(short),
            first=first,
            theta0=theta0.copy(),
            exact=exact,
        )

    def read(self, log: Array) -> Array:
        """Return the measured channels (channels, samples) of a record with this log.

        ``log`` has a row after each sample; the record has the row before it.
        """
        columns = np.empty(log.T.shape)  # each of them in one piece
        columns[:, 0] = self.first
        columns[:, 1:] = log[:-1].T
        found = [column_values(c, columns.T, self.theta0, self.exact)[0] for c in self.channels]
        return np.stack(found)
