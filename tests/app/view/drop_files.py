# SPDX-License-Identifier: Apache-2.0
"""Drops files on a window of X11 as a file manager does (XDND 5): enters, moves over it, drops, and
hands the list over when it is asked for.
    drop_files.py DISPLAY TITLE FILE..."""
import ctypes
import pathlib
import sys
import time

X = ctypes.CDLL("libX11.so.6")
Window = Atom = Time = ctypes.c_ulong
CLIENT_MESSAGE, SELECTION_REQUEST, SELECTION_NOTIFY = 33, 30, 31
LIMIT = 30  # [s]


class ClientMessage(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("window", Window), ("message_type", Atom),
                ("format", ctypes.c_int), ("data", ctypes.c_long * 5)]


class SelectionRequest(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("owner", Window), ("requestor", Window), ("selection", Atom),
                ("target", Atom), ("property", Atom), ("time", Time)]


class Selection(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("requestor", Window), ("selection", Atom), ("target", Atom),
                ("property", Atom), ("time", Time)]


class Event(ctypes.Union):
    _fields_ = [("type", ctypes.c_int), ("client", ClientMessage), ("request", SelectionRequest),
                ("selection", Selection), ("room", ctypes.c_long * 24)]


X.XOpenDisplay.restype = ctypes.c_void_p
X.XOpenDisplay.argtypes = [ctypes.c_char_p]
X.XDefaultRootWindow.restype = Window
X.XDefaultRootWindow.argtypes = [ctypes.c_void_p]
X.XInternAtom.restype = Atom
X.XInternAtom.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int]
X.XCreateSimpleWindow.restype = Window
X.XCreateSimpleWindow.argtypes = [ctypes.c_void_p, Window] + [ctypes.c_int] * 2 + [ctypes.c_uint] * 3 + [ctypes.c_ulong] * 2
X.XSetSelectionOwner.argtypes = [ctypes.c_void_p, Atom, Window, Time]
X.XSendEvent.argtypes = [ctypes.c_void_p, Window, ctypes.c_int, ctypes.c_long, ctypes.c_void_p]
X.XNextEvent.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
for call in (X.XPending, X.XFlush, X.XCloseDisplay):
    call.argtypes = [ctypes.c_void_p]
X.XFetchName.argtypes = [ctypes.c_void_p, Window, ctypes.POINTER(ctypes.c_char_p)]
X.XQueryTree.argtypes = [ctypes.c_void_p, Window] + [ctypes.POINTER(Window)] * 2 + [
    ctypes.POINTER(ctypes.POINTER(Window)), ctypes.POINTER(ctypes.c_uint)]
X.XChangeProperty.argtypes = [ctypes.c_void_p, Window, Atom, Atom, ctypes.c_int, ctypes.c_int, ctypes.c_char_p,
                              ctypes.c_int]


def find(display, window, title):
    """The window of that title, in the tree below another."""
    name = ctypes.c_char_p()
    if X.XFetchName(display, window, ctypes.byref(name)) and name.value and title in name.value:
        return window
    root, parent, count, children = Window(), Window(), ctypes.c_uint(), ctypes.POINTER(Window)()
    X.XQueryTree(display, window, root, parent, children, count)
    for i in range(count.value):
        found = find(display, children[i], title)
        if found:
            return found
    return None


def main():
    display = X.XOpenDisplay(sys.argv[1].encode())
    root = X.XDefaultRootWindow(display)
    target = find(display, root, sys.argv[2].encode())
    if not target:
        sys.exit(f"no window {sys.argv[2]}")
    files = "".join(pathlib.Path(f).absolute().as_uri() + "\r\n" for f in sys.argv[3:]).encode()
    atom = lambda name: X.XInternAtom(display, name.encode(), 0)
    source = X.XCreateSimpleWindow(display, root, 0, 0, 1, 1, 0, 0, 0)
    X.XSetSelectionOwner(display, atom("XdndSelection"), source, 0)

    def tell(message, *data):
        event = Event()
        event.client.type, event.client.window, event.client.format = CLIENT_MESSAGE, target, 32
        event.client.message_type = atom(message)
        event.client.data[:] = [source, *data, *[0] * (4 - len(data))]
        X.XSendEvent(display, target, 0, 0, ctypes.byref(event))
        X.XFlush(display)

    tell("XdndEnter", 5 << 24, atom("text/uri-list"))
    tell("XdndPosition", 0, 300 << 16 | 300, 0, atom("XdndActionCopy"))
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        if not X.XPending(display):
            time.sleep(0.01)
            continue
        event = Event()
        X.XNextEvent(display, ctypes.byref(event))
        if event.type == CLIENT_MESSAGE and event.client.message_type == atom("XdndStatus"):
            if not event.client.data[1] & 1:
                sys.exit("the window takes no files")
            tell("XdndDrop", 0, 0)
        elif event.type == SELECTION_REQUEST:
            asked = event.request
            X.XChangeProperty(display, asked.requestor, asked.property, asked.target, 8, 0, files, len(files))
            answer = Event()
            answer.selection.type, answer.selection.requestor = SELECTION_NOTIFY, asked.requestor
            answer.selection.selection, answer.selection.target = asked.selection, asked.target
            answer.selection.property, answer.selection.time = asked.property, asked.time
            X.XSendEvent(display, asked.requestor, 0, 0, ctypes.byref(answer))
            X.XFlush(display)
        elif event.type == CLIENT_MESSAGE and event.client.message_type == atom("XdndFinished"):
            X.XCloseDisplay(display)
            return
    sys.exit("nobody has taken the files")


main()
