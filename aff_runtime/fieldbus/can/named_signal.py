"""What a DBC or EDS file says of one signal, before anybody has said what it means."""

from __future__ import annotations

from dataclasses import dataclass

from aff_runtime.fieldbus.can.layout import Field, FrameLayout


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedSignal:
    """One signal.

    Attributes
    ----------
    name : as a site file names it: ``MESSAGE.Signal``, or ``NODE.0xIIII[:SS]``.
    field, layout : where it sits, and the frame that carries it.
    called : the file's own words for it: name of the signal, or of the object.
    owner : the message, or the node.
    unit : as the file writes it; empty where it says none.
    senders : nodes that send it, as far as the file says.
    sent_to_us : True for what a node sends, False for what it takes; None where the file leaves
        it open.
    """

    name: str
    field: Field
    layout: FrameLayout
    called: str
    owner: str
    unit: str = ""
    senders: tuple[str, ...] = ()
    sent_to_us: bool | None = None
