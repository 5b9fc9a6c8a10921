/* Browsers start no worker from a disk, and the search runs in one: there a hidden frame takes its
   place. The name is the one that the plugin `offline` knows the like by. */
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(address) {
      super()
      const frame = document.createElement("iframe")
      frame.hidden = true
      document.body.append(frame)
      this.frame = frame
      this.inside = frame.contentWindow
      this.inside.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }))
      this.inside.importScripts = (...more) => Promise.all(more.map((each) => this.load(each)))
      this.ready = this.load(address)
    }

    load(address) {
      return new Promise((done, fail) => {
        const script = this.inside.document.createElement("script")
        script.src = String(address)
        script.onload = done
        script.onerror = fail
        this.inside.document.body.append(script)
      })
    }

    postMessage(data) {
      this.ready.then(() => this.inside.dispatchEvent(new MessageEvent("message", { data })))
    }

    terminate() {
      this.frame.remove()
    }
  }
}
