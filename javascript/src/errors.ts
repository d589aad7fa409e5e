/** What a request is rejected with. The message is the peer's own sentence where the peer has refused. */
export class PeerdError extends Error {
  /**
   * @param request the name of the request, such as `grab`; empty where it concerns the connection.
   * @param answered false: no answer has come, because there is no connection or it has ended; the request may have been carried out.
   */
  constructor(
    sentence: string,
    readonly request: string = '',
    readonly answered: boolean = true,
  ) {
    super(sentence);
    this.name = 'PeerdError';
  }
}
