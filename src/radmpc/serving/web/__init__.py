"""The server: who may speak to it, the page's files, the socket."""
